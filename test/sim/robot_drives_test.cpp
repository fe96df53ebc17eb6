// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/robot_drives.h"
#include "folders.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

namespace cia402::sim {
namespace {

std::vector<SimulatedAxis> axesOf(const std::string& simulation, Problems& problems) {
  const std::string folder = cia402::test::configFolder();
  const YAML::Node tree = YAML::Load(
      "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004}\n"
      "axes:\n"
      "  x: {node_id: 5, drive: generic_cia402, type: revolute, counts_per_turn: 1000,\n"
      "      limits: {lower: -1, upper: 1, velocity: 1, acceleration: 1},\n"
      "      simulation: " +
      simulation + "}\n");
  const auto robot = config::loadRobot(tree, config::profilesIn({folder + "/drives"}), problems);
  return simulatedAxes(robot, folder + "/simulated_drives", problems);
}

TEST(RobotDrives, AnUnconfiguredDriveHasNoNodeIdAndTheIdentityItIsGiven) {
  Problems problems;
  const auto axes = axesOf(
      "{unconfigured: true, serial: 4711, vendor: 0x1234, product: 5, revision: 6}", problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  EXPECT_EQ(axes.at(0).node, 255);
  EXPECT_EQ(axes[0].identity.serial, 4711U);
  EXPECT_EQ(axes[0].identity.vendor, 0x1234U);
  EXPECT_EQ(axes[0].identity.product, 5U);
  EXPECT_EQ(axes[0].identity.revision, 6U);
}

TEST(RobotDrives, OtherwiseADriveHasTheAxisNodeIdAndItsFamilysIdentity) {
  Problems problems;
  const auto axes = axesOf("{drive: generic_cia402_guarding}", problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  EXPECT_EQ(axes.at(0).node, 5);
  EXPECT_FALSE(axes[0].identity.serial);
}

TEST(RobotDrives, ANumberTooLargeForTheIdentityIsRefused) {
  Problems problems;
  axesOf("{serial: 0x100000000}", problems);
  EXPECT_NE(problems.text().find("simulation/serial"), std::string::npos) << problems.text();
}

}  // namespace
}  // namespace cia402::sim
