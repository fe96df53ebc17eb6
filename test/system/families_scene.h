// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>

#include "system/scene.h"

namespace cia402 {

/// A drive family in one of its modes.
struct FamilyMode {
  const char* family;
  const char* counts_per_turn;
  const char* mode;
};

inline void PrintTo(const FamilyMode& tested, std::ostream* out) {
  *out << tested.family << " in " << tested.mode;
}

/// 8388608 encoder counts for 100000 user units: 262144 / 3125, reduced.
constexpr char kSv660cGear[] =
    ", write: [{object: gear_numerator, raw: 262144}, {object: gear_denominator, raw: 3125}]";

/// What a family wants to be told before it is enabled the first time, as options of the axis.
inline std::string panelSteps(const FamilyMode& tested) {
  const std::string family = tested.family;
  if (family == "id286_cnfa") return ", keeps: [motor_current], unwatched_streams: true";
  if (family == "nimotion_stepper") return ", unwatched_streams: true";
  if (family == "sv660c") return kSv660cGear;
  return family == "megmeet_dm5" ? ", adjust: [control_mode]" : "";
}

/// Terminals of a NiMotion with the negative limit switch, the positive one and the home switch,
/// active high.
constexpr char kNimotionSwitches[] =
    ", write: [{object: di0_function, raw: 15}, {object: di0_logic, raw: 1}, "
    "{object: di1_function, raw: 14}, {object: di1_logic, raw: 1}, "
    "{object: di2_function, raw: 31}, {object: di2_logic, raw: 1}]";

/// What the motor of a family is rated at, N m; the SV660C reads it from its drive (H00.12).
inline std::string ratedTorque(const FamilyMode& tested) {
  return tested.family == std::string("sv660c") ? "2.39" : "1.27";
}

/// A joint behind a gear of 50. @param more options of the axis, as
/// ", key: value"
inline std::string familyJoint(const FamilyMode& tested, const std::string& more = {}) {
  const std::string mode = tested.mode;
  return "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "axes:\n"
         "  joint: {node_id: 1, drive: " +
         std::string(tested.family) + ", counts_per_turn: " + tested.counts_per_turn +
         ", gear_ratio: 50.0, rated_torque: " + ratedTorque(tested) + ",\n    mode: " + mode +
         ", modes: [" + mode +
         "],\n"
         "    limits: {lower: -2.5, upper: 2.5, velocity: 0.8, acceleration: 4.0,\n"
         "             effort: 60.0}" +
         panelSteps(tested) + more + "}\n";
}

}  // namespace cia402
