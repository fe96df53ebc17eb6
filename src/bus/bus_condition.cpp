// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/bus_condition.h"

#include <cmath>

namespace cia402::bus {
namespace {

constexpr double kHighLoad = 0.8;  // share of the bit rate

Condition conditionOf(can::BusState state) {
  switch (state) {
    case can::BusState::error_active:
      return Condition::well;
    case can::BusState::error_warning:
    case can::BusState::error_passive:
      return Condition::warning;
    case can::BusState::missing:
    case can::BusState::down:
    case can::BusState::bus_off:
      break;
  }
  return Condition::error;
}

}  // namespace

Summary busSummaryOf(const NetworkSnapshot& snapshot, double load, std::uint64_t skipped) {
  Summary summary{conditionOf(snapshot.bus_state), snapshot.bus_text.str()};
  if (load > kHighLoad) {
    summary.add(Condition::warning, "bus load " + std::to_string(std::lround(100.0 * load)) + " %");
  }
  if (skipped > 0) {
    summary.add(Condition::warning,
                std::to_string(skipped) +
                    " cycles were left out lately, for the thread of the bus came too late: see "
                    "`real time` and `SYNC lateness`, or choose a longer bus/sync_period");
  }
  if (!snapshot.sync_problem.empty()) {
    summary.add(Condition::error, snapshot.sync_problem.str());
  }
  return summary;
}

Condition conditionOf(const can::LinkFinding& finding) {
  return finding.error ? Condition::error : Condition::warning;
}

}  // namespace cia402::bus
