// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/condition.h"
#include "bus/snapshot.h"

namespace cia402::bus {

/// @param warning_stops DriveProfile::warning_stops
/// @param problem is there something that is said of it (AxisWords::problem)?
Condition conditionOf(const drive::AxisState& state, bool warning_stops, bool problem);

Summary summaryOf(const AxisSnapshot& axis, bool warning_stops);

}  // namespace cia402::bus
