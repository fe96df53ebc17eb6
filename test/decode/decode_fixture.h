// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "config/robot.h"
#include "decode/frame_decoder.h"
#include "folders.h"

namespace cia402::decode::test {

/// Shoulder, node 1: 131072 counts on 100 turns for one of the joint, 0.64 N m. Slide, node 2:
/// 10 mm a turn, 1000 counts. Gripper, node 4: values are floats.
inline config::RobotConfig robot() {
  static const char* const kText = R"(
bus: {interface: can0}
axes:
  shoulder: {node_id: 1, drive: generic_cia402, counts_per_turn: 131072, gear_ratio: 100.0,
             rated_torque: 0.64}
  slide: {node_id: 2, drive: generic_cia402, type: prismatic, counts_per_turn: 1000, lead: 0.01,
          mode: profile_position}
  gripper: {node_id: 4, drive: damiao_dm}
)";
  Problems problems;
  const config::RobotConfig robot = config::loadRobot(
      YAML::Load(kText), config::profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  EXPECT_TRUE(problems.empty()) << problems.text();
  return robot;
}

inline canopen::MasterConfig master(const config::RobotConfig& robot) {
  Problems problems;
  canopen::MasterConfig master = config::makeMasterConfig(robot, problems);
  EXPECT_TRUE(problems.empty()) << problems.text();
  return master;
}

inline can::Frame remote(std::uint32_t id, std::uint8_t size) {
  can::Frame frame(id, {});
  frame.remote = true;
  frame.size = size;
  return frame;
}

}  // namespace cia402::decode::test
