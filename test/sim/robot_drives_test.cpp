// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/robot_drives.h"
#include "folders.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

namespace cia402::sim {
namespace {

std::vector<SimulatedDrive> axesOf(const std::string& simulation, Problems& problems) {
  const std::string folder = cia402::test::configFolder();
  const YAML::Node tree = YAML::Load(
      "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004}\n"
      "axes:\n"
      "  x: {node_id: 5, drive: generic_cia402, type: revolute, counts_per_turn: 1000,\n"
      "      limits: {lower: -1, upper: 1, velocity: 1, acceleration: 1},\n"
      "      simulation: " +
      simulation + "}\n");
  const auto robot = config::loadRobot(tree, config::profilesIn({folder + "/drives"}), problems);
  return simulatedDrives(robot, folder + "/simulated_drives", problems);
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

std::vector<SimulatedDrive> pairOf(const std::string& first, const std::string& second,
                                   Problems& problems) {
  const std::string folder = cia402::test::configFolder();
  const YAML::Node tree = YAML::Load(
      "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004}\n"
      "defaults: {drive: generic_cia402, counts_per_turn: 1000,\n"
      "           limits: {velocity: 1, acceleration: 1}}\n"
      "axes:\n"
      "  y: {node_id: 5, device_axis: 1, simulation: " +
      first +
      "}\n"
      "  z: {node_id: 6}\n"
      "  x: {node_id: 5, device_axis: 0, gear_ratio: 2, simulation: " +
      second + "}\n");
  const auto robot = config::loadRobot(tree, config::profilesIn({folder + "/drives"}), problems);
  EXPECT_TRUE(problems.empty()) << problems.text();
  return simulatedDrives(robot, folder + "/simulated_drives", problems);
}

TEST(RobotDrives, AxesOfOneDeviceAreOneDriveEachWithItsOwnMechanics) {
  Problems problems;
  const auto drives =
      pairOf("{drive: generic_cia402_dual, initial_position: 6.283185307179586, serial: 7}",
             "{initial_position: 3.141592653589793}", problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  ASSERT_EQ(drives.size(), 2U);
  EXPECT_EQ(drives[0].name, "y");
  EXPECT_EQ(drives[0].node, 5);
  EXPECT_EQ(drives[0].identity.serial, 7U);
  ASSERT_EQ(drives[0].mechanics.size(), 2U);
  EXPECT_DOUBLE_EQ(drives[0].mechanics[0].initial_position, 1.0) << "half a turn by its gear";
  EXPECT_DOUBLE_EQ(drives[0].mechanics[1].initial_position, 1.0);
  const auto x = findAxis(drives, "x"), y = findAxis(drives, "y"), z = findAxis(drives, "z");
  ASSERT_TRUE(x && y && z);
  EXPECT_EQ(x->drive, 0U);
  EXPECT_EQ(x->axis, 0U);
  EXPECT_EQ(y->drive, 0U);
  EXPECT_EQ(y->axis, 1U);
  EXPECT_EQ(z->drive, 1U);
  EXPECT_FALSE(findAxis(drives, "w"));
}

TEST(RobotDrives, ADriveWithTooFewAxesIsRefused) {
  Problems problems;
  pairOf("{drive: generic_cia402}", "{}", problems);
  EXPECT_NE(
      problems.text().find("axes/y/simulation/drive: the simulated drive has 1 axis, and this "
                           "is its axis 1"),
      std::string::npos)
      << problems.text();
}

TEST(RobotDrives, WhatIsOfTheDriveIsSaidByItsFirstAxis) {
  const std::string dual = "{drive: generic_cia402_dual}";
  for (const char* second : {"{drive: generic_cia402_guarding}", "{serial: 3}",
                             "{unconfigured: true}", "{with: {description: other}}"}) {
    Problems problems;
    pairOf(dual, second, problems);
    EXPECT_NE(problems.text().find("axes/x/simulation/drive: is of the drive that `y` sits in"),
              std::string::npos)
        << second << ": " << problems.text();
  }
  Problems problems;
  pairOf(dual, dual, problems);
  EXPECT_TRUE(problems.empty()) << problems.text();
}

}  // namespace
}  // namespace cia402::sim
