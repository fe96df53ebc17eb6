// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "system/scene.h"

namespace cia402 {

/// A joint behind a gear of 50 with 100000 user units a turn of the motor, whose encoder has 2^23:
/// 8388608 / 100000 = 262144 / 3125, reduced. The rated 2.39 N m are 119.5 N m of the joint.
/// @param more options of the axis, as ", key: value"; they may not repeat those here.
/// @param with further keys of the simulated drive
inline std::string sv660cJoint(const std::string& more = {}, const std::string& simulation = {},
                               const std::string& period = "0.004",
                               const std::string& modes = "[ip, pp, pv, csv, pt]") {
  return "bus: {interface: sim, bitrate: 1000000, sync_period: " + period +
         ", heartbeat: 0.1}\n"
         "axes:\n"
         "  joint: {node_id: 1, drive: sv660c, counts_per_turn: 100000, gear_ratio: 50.0,\n"
         "    rated_torque: 2.39, modes: " +
         modes +
         ",\n"
         "    write: [{object: gear_numerator, raw: 262144},\n"
         "            {object: gear_denominator, raw: 3125}],\n"
         "    limits: {lower: -2.5, upper: 2.5, velocity: 1.5, acceleration: 4.0,\n"
         "             effort: 100.0}" +
         more + ",\n    simulation: {" + simulation +
         "}}\n"
         "groups:\n"
         "  arm: {joints: [joint]}\n";
}

/// As the drive comes with these rows of its dictionary, for `simulation` of sv660cJoint().
inline std::string sv660cDelivered(const std::string& rows) {
  return "with: {dictionary: [" + rows + "]}";
}

/// The text with `what`, which it must have, replaced.
inline std::string sv660cWith(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

/// The joint with further entries of `write`.
inline std::string sv660cWrites(const std::string& writes, std::string yaml = sv660cJoint()) {
  return sv660cWith(std::move(yaml), "raw: 3125}]", "raw: 3125}, " + writes + "]");
}

inline std::uint64_t sv660cNumber(Scene& scene, std::uint16_t index, std::uint8_t sub = 0) {
  return scene.drive("joint").dictionary().find({index, sub})->number;
}

/// Booted and enabled.
struct Sv660cReady : Scene {
  explicit Sv660cReady(const std::string& yaml = sv660cJoint(), const std::string& mode = {})
      : Scene(loadText(yaml)) {
    EXPECT_TRUE(boot()) << told();
    if (!mode.empty()) {
      EXPECT_TRUE(procedure(drive::ProcedureKind::set_mode, {}, mode).success) << told();
    }
    const bus::Answer enabled = procedure(drive::ProcedureKind::enable);
    EXPECT_TRUE(enabled.success) << enabled.message;
  }
};

inline bus::ObjectAnswer sv660cRead(Scene& scene, const std::string& object) {
  return scene.call(bus::ReadObjectCommand{"joint", object});
}
inline bus::Answer sv660cWrite(Scene& scene, const std::string& object, const std::string& value) {
  return scene.call(bus::WriteObjectCommand{"joint", object, value});
}

}  // namespace cia402
