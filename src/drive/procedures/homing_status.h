// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "drive/profile/profile.h"

namespace cia402::drive {

/// What the statusword says of a homing run (CiA 402-2, homing mode, definition of bits 10, 12 and
/// 13).
enum class HomingStatus : std::uint8_t {
  in_progress,      ///< error 0, attained 0, target reached 0
  interrupted,      ///< 0 0 1: interrupted or not started
  attained_moving,  ///< 0 1 0: attained, target not reached yet
  completed,        ///< 0 1 1
  error_moving,     ///< 1 0 0: error, velocity is not 0
  error_stopped,    ///< 1 0 1: error, velocity is 0
  contradictory,    ///< 1 1 x: reserved
};
const char* toString(HomingStatus status);

/// Decodes with the bit numbers of the profile's homing mode (12 and 13 unless it says so). Of a
/// drive that has no target-reached bit in this mode (JVL MIS) homing is over once it stands.
/// @param stands the axis is known to stand
HomingStatus decodeHoming(std::uint16_t statusword, const ModeSpec& mode, bool stands);

}  // namespace cia402::drive
