// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>

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
    angle,       ///< in a turn, 0 to 1
    time,        ///< s since power-on
    total_time,  ///< s with power
  };
  Shows shows = Shows::constant;
  double scale = 1.0;  ///< of the number in the object; of a constant that number
  std::optional<fieldbus::ObjectId> object;
};

/// Objects that say how the drive is, and those that count what it hears wrongly.
struct MonitorsDefinition {
  std::map<fieldbus::ObjectId, MonitorDefinition> shown;
  /// NMT commands that are no two bytes long, or unknown; heartbeats that are not one byte long.
  std::optional<fieldbus::ObjectId> nmt_length, nmt_command, heartbeat_length;
};

}  // namespace cia402::sim
