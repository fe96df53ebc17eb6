// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "system/families_bus_scene.h"
#include "system/traced_scene.h"

namespace cia402 {

/// Modes of the Damiao that an axis can be in.
inline std::vector<const char*> damiaoModes() {
  return {"cyclic_position",  "profile_position", "position_velocity", "position_velocity_torque",
          "profile_velocity", "cyclic_velocity",  "velocity_torque",   "profile_torque"};
}

/// damiaoJoint() in another mode. @param more options of the axis, @param drive keys of the
/// simulated drive that count instead, as "state_machine: {direct_enable: true}"
inline std::string damiaoIn(const std::string& mode, const std::string& more = {},
                            const std::string& drive = {}) {
  std::string yaml = damiaoJoint(more);
  yaml.replace(yaml.find("mode: cyclic_position"), 21, "mode: " + mode);
  const std::string simulation = "simulation: {";
  if (!drive.empty()) {
    yaml.replace(yaml.find(simulation), simulation.size(), simulation + "with: {" + drive + "}, ");
  }
  return yaml;
}

/// What a float in the drive's dictionary is.
inline double floatIn(Scene& scene, std::uint16_t index, std::uint8_t sub = 0) {
  const auto bits = static_cast<std::uint32_t>(numberIn(scene, index, sub));
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<double>(value);
}

/// Each new controlword of a node that travels by RPDO 1, with the state (statusword & 0x6F, of
/// TPDO 1) that was seen last before it: "06@40".
inline std::vector<std::string> commandsSeen(const TracedScene& scene, unsigned node = 4) {
  const std::string rpdo = wireText(can::Frame(0x200 + node, {})) + " ";
  const std::string tpdo = wireText(can::Frame(0x180 + node, {})) + " ";
  std::vector<std::string> seen;
  std::string last, state;
  for (const std::string& line : scene.lines) {
    if (line.compare(0, tpdo.size(), tpdo) == 0) {
      char text[4];
      std::snprintf(text, sizeof text, "%02lX",
                    std::stoul(line.substr(tpdo.size(), 2), nullptr, 16) & 0x6F);
      state = text;
    } else if (line.compare(0, rpdo.size(), rpdo) == 0) {
      const std::string word = line.substr(rpdo.size(), 2);
      if (word != last && !last.empty()) seen.push_back(word + "@" + state);
      last = word;
    }
  }
  return seen;
}

}  // namespace cia402
