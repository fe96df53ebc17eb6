// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <ostream>

#include "sim/bus/faults.h"

namespace cia402 {

/// Chance of a frame to be lost, sent twice, or held back by up to 20 ms.
struct Disturbance {
  enum class Kind { lost, duplicated, delayed };
  Kind kind;
  double rate;

  sim::FaultRates rates() const {
    sim::FaultRates made;
    (kind == Kind::lost         ? made.loss
     : kind == Kind::duplicated ? made.duplicate
                                : made.delay) = rate;
    made.longest_delay = std::chrono::milliseconds(20);
    return made;
  }
  friend std::ostream& operator<<(std::ostream& out, const Disturbance& disturbance) {
    constexpr const char* kNames[] = {"lost", "duplicated", "delayed"};
    return out << disturbance.rate << " " << kNames[static_cast<int>(disturbance.kind)];
  }
};

constexpr Disturbance kDisturbances[] = {
    {Disturbance::Kind::lost, 0.01},       {Disturbance::Kind::lost, 0.1},
    {Disturbance::Kind::duplicated, 0.01}, {Disturbance::Kind::duplicated, 0.1},
    {Disturbance::Kind::delayed, 0.01},    {Disturbance::Kind::delayed, 0.1}};

}  // namespace cia402
