// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace cia402::drive {

/// What a value means physically; decides which entry of the profile's unit system scales it.
enum class Quantity : std::uint8_t {
  none,
  position,
  distance,  ///< a difference of positions: following error, windows; no offset
  velocity,
  acceleration,
  jerk,
  torque,
  current,
  voltage,
  temperature,
  time,
};

/// Device units of one quantity: a device value 1 is `scale` of `base` per `per`. Where an
/// acceleration is told as the time that it takes to a speed, bigger is slower: a device value 1 is
/// then `scale` seconds, and the speed is `to` of `base` per `per`.
struct UnitSpec {
  enum class Base : std::uint8_t {
    count,  ///< axis option counts_per_turn to the motor turn
    turn,
    radian,
    degree,
    per_mille_of_rated,  ///< torque: 1/1000 of the rated torque
    newton_metre,
    ampere,
    volt,
    celsius,
    second,
    one,
  };
  Base base = Base::one;
  int per_seconds = 0;      ///< power of 1/s: velocity 1, acceleration 2, jerk 3
  bool per_minute = false;  ///< one of these is per minute instead: "turn/min", "turn/min/s"
  double scale = 1.0;
  double to = 0.0;  ///< > 0: the device tells times
};
using Units = std::map<Quantity, UnitSpec>;

/// Other units of a drive that counts as a setting of its own says.
struct UnitSystems {
  std::string object;  ///< that says which count, by name; empty: there are no others
  std::map<std::int64_t, Units> others;  ///< its numbers, and what counts otherwise then
};

}  // namespace cia402::drive
