// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cia402::campaign {

/// a1 is axis 1 of node 4, a2 its axis 0, with another gear and another direction; a3 sits alone.
/// @param keys of the drive's profile, @param habits of the drive
inline std::string dualRobot(const std::string& keys = "", const std::string& habits = "") {
  const std::string shared = keys.empty() ? "" : ", profile_keys: {" + keys + "}";
  const std::string with = habits.empty() ? "" : ", with: {" + habits + "}";
  const std::string common =
      ", drive: generic_cia402, mode: cyclic_position, command_timeout: 0.2,\n"
      "    counts_per_turn: 4096, rated_torque: 1.0,\n"
      "    limits: {lower: -3, upper: 3, velocity: 1, acceleration: 4, effort: 100}";
  return "bus: {interface: can0, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "recorder: {duration: 1, keep: 0}\naxes:\n"
         "  a1: {node_id: 4, device_axis: 1, gear_ratio: 50.0, direction: -1" +
         common + shared + ",\n    simulation: {drive: generic_cia402_dual" + with +
         ", initial_position: 0.5}}\n"
         "  a2: {node_id: 4, device_axis: 0, gear_ratio: 80.0" +
         common + shared + ",\n    simulation: {drive: generic_cia402_dual" + with +
         ", initial_position: -0.25}}\n"
         "  a3: {node_id: 5, gear_ratio: 50.0" +
         common + "}\ngroups:\n  g1: {joints: [a1, a2, a3], stop_group_on_fault: false}\n";
}

}  // namespace cia402::campaign
