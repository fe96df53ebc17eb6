// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "drive/axis/core.h"

namespace cia402::drive {

// The axis in sentences that take several of its parts; made on demand only.

/// What was commanded, what the drive shows and its last emergency.
std::string report(const AxisCore& axis);
/// Axis::obstacle()
std::string obstacle(const AxisCore& axis);
/// Of an axis in motion: "at 2.312 rad, with 1.480 rad/s, the axis comes to its limit of position
/// 2.500 rad", or "goes on beyond" that. @pre it has a limit there
std::string limitText(const AxisState& state, const AxisConfig& config);
/// "statusword bit 9 is 0, the drive does not listen: ...", of what is not met.
std::string needText(const StatusNeed& need);
/// Axis::motionRefusal(). @param busy a procedure runs
std::string motionRefusal(const AxisCore& axis, bool busy);
/// Why the drive takes no enabling now; empty: it may.
std::string enablingRefusal(const AxisCore& axis);
/// Why an object that shifts coordinates must not be written now; empty: it may.
std::string calibrationRefusal(const AxisCore& axis);

}  // namespace cia402::drive
