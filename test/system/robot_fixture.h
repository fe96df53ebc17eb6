// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "folders.h"
#include "tools/virtual_robot.h"

namespace cia402 {

/// A robot's YAML file as the node would load it. Problems fail the test with their text.
struct LoadedRobot {
  config::RobotConfig robot;
  canopen::MasterConfig master;
  std::vector<sim::SimulatedDrive> drives;
};

inline LoadedRobot loadTree(const YAML::Node& tree) {
  LoadedRobot loaded;
  Problems problems;
  const std::string folder = cia402::test::configFolder();
  loaded.robot = config::loadRobot(tree, config::profilesIn({folder + "/drives"}), problems);
  if (problems.empty()) loaded.master = config::makeMasterConfig(loaded.robot, problems);
  if (problems.empty()) {
    loaded.drives = sim::simulatedDrives(loaded.robot, folder + "/simulated_drives", problems);
  }
  EXPECT_TRUE(problems.empty()) << problems.text();
  return loaded;
}

inline LoadedRobot loadFile(const std::string& name) {
  Problems problems;
  const YAML::Node tree =
      config::readRobotFile(cia402::test::configFolder() + "/robots/" + name, problems);
  EXPECT_TRUE(problems.empty()) << problems.text();
  return loadTree(tree);
}

/// All that was told so far, a line each.
inline std::string told(const tools::VirtualRobot& robot) {
  std::string text;
  for (const bus::Event& event : robot.events()) text += event.text.str() + "\n";
  return text;
}

inline bool allReady(tools::VirtualRobot& robot) {
  for (const bus::AxisUnit& unit : robot.network().cycle().units()) {
    if (unit.axis.state().health != fieldbus::Health::ready) return false;
  }
  return true;
}

}  // namespace cia402
