// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
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
  /// What the drive does with the motor in it.
  enum class Reaction : std::uint8_t {
    brakes,  ///< to rest, and switches its power off then
    coasts,  ///< lets it go at once
  };
  std::string text, cause, remedy;
  std::optional<Reaction> reaction{};  ///< nothing: as DriveProfile::fault_reaction says
  Missing missing = Missing::nothing;
  Reset reset = Reset::by_bit;
  Duration wait{0};         ///< since the fault, before which the drive takes no reset
  bool loses_zero = false;  ///< what the drive counts from is gone with it
};

/// A further number that the drive tells of an error, which says more than its code (603Fh).
struct ErrorDetails {
  std::string object;                        ///< a whole number; empty: there is none
  std::uint64_t bits = ~std::uint64_t{0};    ///< of it, that are a code as the drive shows it
  std::string prefix;                        ///< of such a code for people: "E" of "E234"
  int digits = 1;                            ///< hexadecimal ones, at least
  std::map<std::uint64_t, ErrorText> codes;  ///< text, cause and remedy of those that are known
};

/// Where the maker keeps the past errors, instead of 1003h: one is selected by its number, 0 the
/// newest, and shown. Their codes are those of ErrorDetails.
struct AlarmMemory {
  std::string select, code;  ///< objects by their names
  std::string time;          ///< when it came, since power-on; empty: nothing tells
  unsigned entries = 0;      ///< 0: there is no such memory
};

/// A past fault in objects of its own, by their names.
struct FaultObject {
  std::string code;               ///< a whole number; 0: none was
  std::vector<std::string> with;  ///< what was so when it came
};

/// Where the maker keeps the past faults each in objects of its own, instead of 1003h.
struct FaultObjects {
  std::uint16_t base = 0;           ///< bits that make a code of `errors` of such a number
  std::vector<FaultObject> faults;  ///< the newest first; empty: there is no such memory
};

/// A known code that comes without a fault (statusword bit 7).
struct WarningText {
  enum class Reaction : std::uint8_t {
    goes_on,  ///< it only tells
    holds,    ///< the drive brings the motor to rest and holds it, and may let it go by itself
    stops,    ///< the drive stops like in a fault
  };
  std::string text, cause, remedy;
  std::optional<Reaction> reaction;  ///< nothing: as DriveProfile::warning_stops says
};

}  // namespace cia402::drive
