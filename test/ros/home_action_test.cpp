// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/home_action.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::ros_node {
namespace {

using namespace std::chrono_literals;
using bus::ProcedureStage;
using testing::ElementsAre;
using testing::IsNan;

/// Searches for home, and is given up at 30 s.
bus::AxisSnapshot searching() {
  bus::AxisSnapshot axis;
  axis.procedure = drive::ProcedureKind::home;
  axis.procedure_running = true;
  axis.procedure_deadline = Time(30s);
  axis.words.step.assign("searching home");
  axis.words.waiting_for.assign("homing attained");
  return axis;
}

TEST(HomeAction, TellsWhatAnAxisDoesAndWaitsFor) {
  bus::AxisSnapshot axis = searching();
  EXPECT_EQ(homingStep(ProcedureStage::running, axis), "searching home; waits for homing attained");
  EXPECT_EQ(homingStep(ProcedureStage::waiting, axis), "waits for its turn");
  EXPECT_EQ(homingStep(ProcedureStage::succeeded, axis), "homed");
  EXPECT_EQ(homingStep(ProcedureStage::failed, axis), "has ended without success");
  axis.words.waiting_for.assign("");
  EXPECT_EQ(homingStep(ProcedureStage::running, axis), "searching home");
}

TEST(HomeAction, TellsNoStepOfAnotherProcedure) {
  bus::AxisSnapshot axis = searching();
  axis.procedure = drive::ProcedureKind::enable;
  EXPECT_EQ(homingStep(ProcedureStage::running, axis), "begins or ends");
  EXPECT_THAT(homingTimeLeft(ProcedureStage::running, axis, Time(1s)), IsNan());
  axis = searching();
  axis.procedure_running = false;
  EXPECT_EQ(homingStep(ProcedureStage::running, axis), "begins or ends");
}

TEST(HomeAction, CountsTheTimeLeftDown) {
  const bus::AxisSnapshot axis = searching();
  EXPECT_DOUBLE_EQ(homingTimeLeft(ProcedureStage::running, axis, Time(28500ms)), 1.5);
  EXPECT_DOUBLE_EQ(homingTimeLeft(ProcedureStage::running, axis, Time(31s)), 0.0);
  EXPECT_THAT(homingTimeLeft(ProcedureStage::waiting, axis, Time(1s)), IsNan());
  EXPECT_THAT(homingTimeLeft(ProcedureStage::succeeded, axis, Time(1s)), IsNan());
}

TEST(HomeAction, TellsTheResultInTheOrderOfTheGoalAlsoOfWhatWasLeftOut) {
  config::RobotConfig robot;
  robot.axes.resize(3);
  for (std::size_t i = 0; i < 3; ++i)
    robot.axes[i].name = std::string(1, static_cast<char>('a' + i));
  bus::NetworkSnapshot snapshot;
  snapshot.axes.resize(3);
  snapshot.axes[1].state.homed = true;
  bus::ProcedureReport answer;
  answer.message = "two of three";
  answer.axes = {{0, true, "a: homed"}, {2, false, "c: homing stopped"}};
  const auto result =
      homeResult({{2, 0, true}, {1, 0, false}, {0, 0, true}}, answer, robot, snapshot);
  EXPECT_FALSE(result.success);
  EXPECT_EQ(result.message, "two of three");
  EXPECT_THAT(result.axes, ElementsAre("c", "b", "a"));
  EXPECT_THAT(result.homed, ElementsAre(false, true, true));
  EXPECT_THAT(result.messages, ElementsAre("c: homing stopped", "b: was not begun", "a: homed"));
}

}  // namespace
}  // namespace cia402::ros_node
