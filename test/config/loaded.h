// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "config/robot.h"
#include "folders.h"

namespace cia402::config {

/// A robot's file with what is wrong in it.
struct LoadedRobot {
  RobotConfig robot;
  std::string problems;
};

/// Loads it with the drive profiles of the package.
inline LoadedRobot loadText(const std::string& yaml) {
  Problems problems;
  LoadedRobot loaded;
  loaded.robot =
      loadRobot(YAML::Load(yaml), profilesIn({test::configFolder() + "/drives"}), problems);
  loaded.problems = problems.text();
  return loaded;
}

/// A robot of two axes without mistakes.
inline constexpr const char* kArm = R"(
bus: {interface: can0, sync_period: 0.004}
defaults: {drive: generic_cia402, counts_per_turn: 4000, limits: {velocity: 2.0, acceleration: 8.0}}
axes:
  shoulder: {node_id: 1, gear_ratio: 50.0, limits: {lower: -3.0, upper: 3.0}}
  elbow: {node_id: 2, homing: {method: 17}}
)";

/// The arm with the first `from` replaced by `to`.
inline LoadedRobot changed(const std::string& from, const std::string& to) {
  std::string text = kArm;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return loadText(text.replace(at, from.size(), to));
}

}  // namespace cia402::config
