// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cia402_driver/common/time.h"

namespace cia402::drive {

/// A known error code of the family.
struct ErrorText {
  /// What the drive reports as missing of that which this program sends.
  enum class Missing : std::uint8_t {
    nothing,
    cycle,    ///< the signal that begins a cycle
    outputs,  ///< what travels to the drive in it
  };
  /// What ends the fault.
  enum class Reset : std::uint8_t {
    by_bit,       ///< controlword bit 7, once its cause is gone
    by_itself,    ///< the drive, once its cause is gone
    power_cycle,  ///< nothing but switching the drive's power off and on
  };
  std::string text, cause, remedy;
  Missing missing = Missing::nothing;
  Reset reset = Reset::by_bit;
  Duration wait{0};  ///< since the fault, before which the drive takes no reset
};

/// A known code that comes without a fault (statusword bit 7).
struct WarningText {
  enum class Reaction : std::uint8_t {
    goes_on,  ///< it only tells
    holds,    ///< the drive brings the motor to rest and holds it, and may let it go by itself
  };
  std::string text, cause, remedy;
  std::optional<Reaction> reaction;  ///< nothing: as DriveProfile::warning_stops says
};

}  // namespace cia402::drive
