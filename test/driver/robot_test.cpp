// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The driver as a program embeds it. What moves is shown by examples/move_arm.cpp.
#include "cia402_driver/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <thread>

#include "folders.h"

namespace cia402 {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using namespace std::chrono_literals;

Robot::Options options() {
  Robot::Options options;
  options.config_folder = test::configFolder();
  return options;
}

Result<Robot> demo(const Robot::Options& with = options()) {
  return Robot::load(test::configFolder() + "/robots/demo.yaml", with);
}

TEST(EmbeddedRobot, KnowsItsJointsAndGroupsBeforeItStarts) {
  auto robot = demo();
  ASSERT_TRUE(robot.ok()) << robot.error().message;
  EXPECT_THAT(robot->joints(), ElementsAre("shoulder", "elbow", "wrist", "tool", "gripper"));
  EXPECT_THAT(robot->groups(), ElementsAre("arm"));
  EXPECT_THAT(robot->jointsOf("arm"), ElementsAre("shoulder", "elbow", "wrist", "tool", "gripper"));
  EXPECT_THAT(robot->jointsOf("leg"), IsEmpty());
  EXPECT_FALSE(robot->ready());
}

TEST(EmbeddedRobot, AFileThatIsNotThereIsNamed) {
  const auto robot = Robot::load("/nowhere/robot.yaml", options());
  ASSERT_FALSE(robot.ok());
  EXPECT_THAT(robot.error().message, HasSubstr("/nowhere/robot.yaml"));
}

TEST(EmbeddedRobot, EveryMistakeOfAFileIsTold) {
  const std::string file = testing::TempDir() + "wrong_robot.yaml";
  std::ofstream(file) << "bus: {interface: sim, bitrate: 1000000, sync_perod: 0.004}\n"
                         "axes: {a: {node_id: 1, drive: no_such_drive}}\n";
  const auto robot = Robot::load(file, options());
  ASSERT_FALSE(robot.ok());
  EXPECT_THAT(robot.error().message, HasSubstr("did you mean `sync_period`?"));
  EXPECT_THAT(robot.error().message, HasSubstr("no_such_drive"));
}

TEST(EmbeddedRobot, WhatIsAskedBeforeTheStartIsRefused) {
  auto robot = demo();
  ASSERT_TRUE(robot.ok());
  const Answer answer = robot.value().run(Procedure::enable).get();
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message, "refused: the driver is not running");
  const bus::TrajectoryOutcome outcome =
      robot.value().follow("arm", robot->jointsOf("arm"), {{{0, 0, 0, 0, 0}, {}, {}, 1s}}).get();
  EXPECT_EQ(outcome.end, bus::TrajectoryEnd::refused);
}

TEST(EmbeddedRobot, ShowsItsJointsAsUnknownBeforeTheStart) {
  auto robot = demo();
  ASSERT_TRUE(robot.ok());
  const std::vector<JointStatus> joints = robot->state();
  ASSERT_EQ(joints.size(), 5u);
  for (const JointStatus& joint : joints) {
    EXPECT_TRUE(std::isnan(joint.position)) << joint.name;
    EXPECT_FALSE(joint.enabled) << joint.name;
    EXPECT_FALSE(joint.homed) << joint.name;
  }
}

TEST(EmbeddedRobot, EnablesSimulatedDrivesAndShowsThem) {
  auto loaded = demo();
  ASSERT_TRUE(loaded.ok());
  Robot& robot = loaded.value();
  robot.start();
  while (!robot.ready()) std::this_thread::sleep_for(10ms);  // the drives boot, on their own time
  const Answer answer = robot.run(Procedure::enable, "wrist").get();
  EXPECT_TRUE(answer.success) << answer.message;
  const auto enabled = [&] { return robot.state()[2].enabled; };
  while (!enabled()) std::this_thread::sleep_for(10ms);
  const std::vector<JointStatus> joints = robot.state();
  EXPECT_EQ(joints[2].name, "wrist");
  EXPECT_EQ(joints[2].condition, "operation enabled");
  EXPECT_NEAR(joints[0].position, -2.2, 1e-3) << "simulation: initial_position";
  EXPECT_FALSE(joints[0].enabled);
  const Answer read = robot.readObject("wrist", "6041:00").get();
  EXPECT_TRUE(read.success) << read.message;
  EXPECT_TRUE(robot.run(Procedure::disable).get().success);
}

TEST(EmbeddedRobot, ARefusedCommandIsTold) {
  std::vector<std::string> told;
  Robot::Options with = options();
  with.log = [&](const std::string& text) { told.push_back(text); };
  auto loaded = demo(with);
  ASSERT_TRUE(loaded.ok());
  Robot& robot = loaded.value();
  robot.command("ankle", 1.0);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.back(), "there is no axis \"ankle\"");
  robot.start();
  while (!robot.ready()) std::this_thread::sleep_for(10ms);
  robot.command("wrist", 1.0);  // it is not enabled
  const auto refused = [&] {
    robot.poll();
    return !told.empty() && told.back().find("not enabled") != std::string::npos;
  };
  while (!refused()) std::this_thread::sleep_for(10ms);
  EXPECT_THAT(told.back(), HasSubstr("wrist (node 3)"));
}

}  // namespace
}  // namespace cia402
