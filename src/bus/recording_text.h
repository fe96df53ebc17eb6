// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <iosfwd>
#include <string>

#include "bus/recording.h"
#include "canopen/config.h"
#include "config/robot.h"
#include "decode/frame_decoder.h"

namespace cia402::bus {

/// The frames as `candump -L` logs them, with R or T for received and sent.
/// @param wall what the wall clock (since 1970) is ahead of the bus' clock.
void writeFrames(std::ostream& out, const Recording& recording, const std::string& interface,
                 std::chrono::nanoseconds wall);

/// The recording in words: a head that says why, then a line for each frame and, between them, for
/// each change of an axis, each event and each step of a procedure.
void writeText(std::ostream& out, const Recording& recording, const config::RobotConfig& robot,
               const canopen::MasterConfig& master, std::chrono::nanoseconds wall);

/// What changed from one record of an axis to the next, in words; its numbers if nothing did.
/// @param before nullptr: everything is told.
std::string axisText(const AxisRecord* before, const AxisRecord& record,
                     const drive::AxisConfig& axis);

/// UTC, to the millisecond: "2026-11-21T14-37-08.123Z", without colons for file names.
std::string timeStamp(std::chrono::nanoseconds since_1970);

}  // namespace cia402::bus
