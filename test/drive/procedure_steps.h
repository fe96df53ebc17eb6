// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "drive/axis_fixture.h"

namespace cia402::drive::test {

/// Performs a procedure. @return what it told on its way, "step | what is waited for", each change.
inline std::vector<std::string> stepsOf(Bench& bench, ProcedureKind kind,
                                        const std::string& mode = {}, double position = 0.0) {
  std::vector<std::string> steps;
  const auto before = bench.each_cycle;
  bench.each_cycle = [&] {
    const ProcedureStatus& status = bench.axis.procedure();
    const std::string told = status.step + " | " + status.waiting_for;
    if (status.running && (steps.empty() || steps.back() != told)) steps.push_back(told);
    if (before) before();
  };
  bench.perform(kind, mode, position);
  bench.each_cycle = before;
  return steps;
}

}  // namespace cia402::drive::test
