// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "fieldbus/object.h"

namespace cia402::sim {

/// What an object of the maker's shows of the first axis as it is now.
struct MonitorDefinition {
  enum class Shows : std::uint8_t {
    constant,
    object,      ///< the number of another object
    speed,       ///< turns/s
    torque,      ///< in rated torques
    load,        ///< the same without its sign
    angle,       ///< in a turn, or in one of its `periods`, 0 to 1
    outputs,     ///< digital ones that are on at their terminals, in the bits of 60FEh
    time,        ///< s since power-on
    total_time,  ///< s with power
  };
  Shows shows = Shows::constant;
  double scale = 1.0;  ///< of the number in the object; of a constant that number
  std::optional<fieldbus::ObjectId> object;
  std::optional<fieldbus::ObjectId> less;     ///< of an object: its number is taken away
  std::optional<fieldbus::ObjectId> periods;  ///< of an angle: how many of them a turn has
  unsigned first_bit = 0, bits = 64;          ///< of outputs or an object: these alone
};

/// Objects that say how the drive is, and those that count what it hears wrongly.
struct MonitorsDefinition {
  std::map<fieldbus::ObjectId, MonitorDefinition> shown;
  /// Objects that show what another one showed when the selected past error came: first of both.
  std::vector<std::pair<fieldbus::ObjectId, fieldbus::ObjectId>> at_alarm;
  /// NMT commands that are no two bytes long, or unknown; heartbeats that are not one byte long.
  std::optional<fieldbus::ObjectId> nmt_length, nmt_command, heartbeat_length;
};

}  // namespace cia402::sim
