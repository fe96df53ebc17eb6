// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fieldbus/object.h"

namespace cia402::sim {

/// What an encoder still knows when the power comes back.
enum class EncoderKind : std::uint8_t {
  absolute,     ///< everything, by its battery
  single_turn,  ///< where in its turn it stands
  incremental,  ///< nothing: it begins at 0
};

/// The maker's objects of an absolute encoder: how it is used, and what it tells beyond the 32 bits
/// of 6064h.
struct AbsoluteEncoderDefinition {
  /// A number of 64 bits in two objects.
  struct Wide {
    std::optional<fieldbus::ObjectId> low, high;
  };
  std::int64_t counts = 0;                   ///< of a turn; 0: the drive has none of all this
  std::optional<fieldbus::ObjectId> system;  ///< which of `kinds` counts, since power-on
  std::vector<EncoderKind> kinds;
  std::optional<fieldbus::ObjectId> turns, single_turn;  ///< whole turns, 16 bits; the rest
  Wide encoder;                                          ///< counts of the encoder itself
  Wide mechanical;                                       ///< counts from the drive's zero
  /// The same within one turn of the load, which has so many counts, or so many turns of the motor.
  Wide rotary, load_counts;
  std::optional<fieldbus::ObjectId> rotary_units;  ///< in position units
  Wide load_gear;                                  ///< numerator and denominator
  std::optional<fieldbus::ObjectId> overflows;     ///< how often 65536 turns have passed
  /// While it is 0 more than 65535 turns are the fault `turns_overflow`.
  std::optional<fieldbus::ObjectId> overflow_masked;
  std::optional<fieldbus::ObjectId> reset;  ///< 2 forgets the turns
  /// What it reports at power-on where the warning `battery_warning` stood when the power went: the
  /// turns are lost.
  std::string battery_fault;
};

}  // namespace cia402::sim
