// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "bus/snapshot.h"

namespace cia402::bus {

/// How well an axis is, for diagnostics and log.
enum class Condition : std::uint8_t {
  well,
  warning,  ///< it does what it is told, or is about to, but something wants to be looked at
  error,    ///< it does not, or nobody knows
};

/// @param warning_stops DriveProfile::warning_stops
/// @param problem is there something that is said of it (AxisWords::problem)?
Condition conditionOf(const drive::AxisState& state, bool warning_stops, bool problem);

/// The condition of an axis in words: "operation enabled", or what is wrong.
struct AxisSummary {
  Condition condition = Condition::well;
  std::string text;
};
AxisSummary summaryOf(const AxisSnapshot& axis, bool warning_stops);

}  // namespace cia402::bus
