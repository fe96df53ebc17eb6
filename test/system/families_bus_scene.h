// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "system/families_scene.h"
#include "system/stranger.h"
#include "system/traced_scene.h"

namespace cia402 {

/// The families, each in a mode that goes to positions.
constexpr FamilyMode kBusNimotion{"nimotion_stepper", "4000", "csp"},
    kBusId286{"id286_cnfa", "10000", "pp"}, kBusDm5{"megmeet_dm5", "8388608", "csp"},
    kBusSv660c{"sv660c", "100000", "ip"}, kBusDamiao{"damiao_dm", "", "csp"};

inline auto allFamilies() {
  return testing::Values(kBusNimotion, kBusId286, kBusDm5, kBusSv660c, kBusDamiao);
}

inline std::string nameOfFamily(const testing::TestParamInfo<FamilyMode>& tested) {
  return tested.param.family;
}

inline bool is(const FamilyMode& tested, const FamilyMode& other) {
  return std::string(tested.family) == other.family;
}

/// What an axis of the family must say of its motor: a gear of 50 where it has none inside.
inline std::string busMotor(const FamilyMode& tested) {
  if (is(tested, kBusDamiao))
    return ", limits: {lower: -2.5, upper: 2.5, velocity: 0.8, "
           "acceleration: 4.0, effort: 5.0}";
  return ", counts_per_turn: " + std::string(tested.counts_per_turn) +
         ", gear_ratio: 50.0, rated_torque: 1.27" + panelSteps(tested) +
         ", limits: {lower: -2.5, upper: 2.5, velocity: 0.8, acceleration: 4.0, "
         "effort: 60.0}";
}

/// A line of `axes`. @param more options, as ", key: value"
inline std::string busAxis(const FamilyMode& tested, const std::string& name = "joint",
                           unsigned node = 1, const std::string& more = {}) {
  const std::string modes =
      more.find("modes:") == std::string::npos ? ", modes: [" + std::string(tested.mode) + "]" : "";
  return "  " + name + ": {node_id: " + std::to_string(node) + ", drive: " + tested.family +
         ", mode: " + tested.mode + modes + busMotor(tested) + more + "}\n";
}

/// What the bus of a robot is like.
struct BusOptions {
  std::string bitrate = "1000000", period = "0.004", heartbeat = "0.1";
  std::string more;  ///< as ", key: value"
};

inline std::string busRobot(const std::string& axes, const BusOptions& bus = {}) {
  return "bus: {interface: sim, bitrate: " + bus.bitrate + ", sync_period: " + bus.period +
         ", heartbeat: " + bus.heartbeat + bus.more + "}\naxes:\n" + axes;
}

/// One axis, `joint`, at node 1.
inline std::string busJoint(const FamilyMode& tested, const std::string& more = {}) {
  return busRobot(busAxis(tested, "joint", 1, more));
}

constexpr Duration kFamilyBoot = std::chrono::seconds(30);

inline void enableJoint(Scene& scene, const std::string& name = "joint") {
  const bus::Answer enabled = scene.procedure(drive::ProcedureKind::enable, name);
  ASSERT_TRUE(enabled.success) << enabled.message << scene.told();
}

/// Boots and enables an axis, which then goes where it is told to, by its motor.
inline void expectGoes(Scene& scene, double goal, const std::string& name = "joint") {
  const double from = scene.position(name), told = scene.state(name).position;
  ASSERT_EQ(scene.setpoint(name, told + goal), "");
  scene.run(std::chrono::seconds(3));
  EXPECT_NEAR(scene.position(name) - from, goal, 1e-3) << scene.told();
}

inline void expectBootsAndGoes(Scene& scene, double goal = 0.3) {
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  expectGoes(scene, goal);
}

inline std::uint64_t numberIn(Scene& scene, std::uint16_t index, std::uint8_t sub = 0,
                              const std::string& name = "joint") {
  const sim::Entry* entry = scene.drive(name).dictionary().find({index, sub});
  EXPECT_NE(entry, nullptr) << std::hex << index;
  return entry == nullptr ? 0 : entry->number;
}

/// Every frame of an identifier is lost, at one receiver or at all.
inline void loseFrames(Scene& scene, std::uint32_t id, unsigned count = 1000000,
                       std::string_view receiver = {}) {
  sim::FaultRule rule;
  rule.id = id;
  rule.count = count;
  rule.receiver = receiver;
  scene.world().bus().faults().add(rule);
}

/// Why such a robot is refused before there is a bus; empty if it is not.
inline std::string problemsOfRobot(const std::string& yaml) {
  Problems problems;
  const config::RobotConfig robot = config::loadRobot(
      YAML::Load(yaml), config::profilesIn({test::configFolder() + "/drives"}), problems);
  if (problems.empty()) (void)config::makeMasterConfig(robot, problems);
  return problems.text();
}

}  // namespace cia402
