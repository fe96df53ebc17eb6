// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Limits of joints that others state: the strictest counts.
#include "config/described_limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loaded.h"
#include "config/reload.h"

namespace cia402::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// The arm (2 rad/s, 8 rad/s², shoulder from -3 to 3), with what others state.
std::string armWith(const std::string& limits_from) {
  return std::string(kArm) + "limits_from: {" + limits_from + "}\n";
}

TEST(DescribedLimits, TheStrictestOfAllCounts) {
  const LoadedRobot loaded = loadText(armWith(
      "robot_description: {shoulder: {lower: -2.5, upper: 3.5, velocity: 1.5, effort: 40}}, "
      "joint_limits: {shoulder: {velocity: 1.8, acceleration: 3.0, jerk: 60}}"));
  EXPECT_EQ(loaded.problems, "");
  const motion::JointLimits& limits = loaded.robot.axes.at(0).limits;
  EXPECT_EQ(limits.lower, -2.5);
  EXPECT_EQ(limits.upper, 3.0);
  EXPECT_EQ(limits.velocity, 1.5);
  EXPECT_EQ(limits.acceleration, 3.0);
  EXPECT_EQ(limits.jerk, 60.0);
  EXPECT_EQ(limits.effort, 40.0);
  const motion::JointLimits& other = loaded.robot.axes.at(1).limits;
  EXPECT_EQ(other.velocity, 2.0);
  EXPECT_FALSE(other.effort.has_value());
}

TEST(DescribedLimits, WhatDiffersIsTold) {
  const LoadedRobot loaded =
      loadText(armWith("robot_description: {shoulder: {lower: -3, upper: 3.5, velocity: 1.5}}"));
  EXPECT_THAT(loaded.robot.warnings,
              ElementsAre(AllOf(
                  HasSubstr("shoulder: its limits differ, the strictest count:"),
                  HasSubstr("upper 3 of axes/shoulder/limits, not 3.5 of robot_description"),
                  HasSubstr("velocity 1.5 of robot_description, not 2 of axes/shoulder/limits"),
                  testing::Not(HasSubstr("lower")))));
  EXPECT_THAT(loaded.robot.notes, IsEmpty());
}

TEST(DescribedLimits, WhatIsStatedElsewhereAloneIsNoWarning) {
  const LoadedRobot loaded =
      loadText(armWith("robot_description: {shoulder: {velocity: 2.0000001, jerk: 40}}"));
  EXPECT_THAT(loaded.robot.warnings, IsEmpty());
  EXPECT_THAT(loaded.robot.notes,
              ElementsAre("shoulder: limits stated elsewhere: jerk 40 of robot_description"));
  EXPECT_EQ(loaded.robot.axes.at(0).limits.velocity, 2.0);
}

TEST(DescribedLimits, RangesThatExcludeEachOtherAreRefused) {
  const LoadedRobot loaded =
      loadText(armWith("robot_description: {shoulder: {lower: 3.5, upper: 4.0}}"));
  EXPECT_THAT(loaded.problems, AllOf(HasSubstr("axes/shoulder/limits: joint shoulder cannot move"),
                                     HasSubstr("lower limit is 3.5 of robot_description"),
                                     HasSubstr("upper limit 3 of axes/shoulder/limits")));
}

TEST(DescribedLimits, OfAJointThatIsNotThereAreRefused) {
  EXPECT_THAT(loadText(armWith("mine: {shuolder: {velocity: 1}}")).problems,
              AllOf(HasSubstr("limits_from/mine/shuolder: there is no joint `shuolder`"),
                    HasSubstr("did you mean `shoulder`?")));
}

TEST(DescribedLimits, WrongValuesAreRefusedWithTheirPath) {
  EXPECT_THAT(loadText(armWith("mine: {elbow: {velocity: -1}}")).problems,
              HasSubstr("limits_from/mine/elbow/velocity"));
}

TEST(DescribedLimits, AJointWithoutEndHasNoneOfPosition) {
  const LoadedRobot loaded = loadText(
      "bus: {interface: can0}\nlimits_from: {urdf: {wheel: {lower: -1, upper: 1, "
      "velocity: 3}}}\naxes: {wheel: {node_id: 1, drive: generic_cia402, type: "
      "continuous, counts_per_turn: 4000, "
      "limits: {acceleration: 9}}}\n");
  EXPECT_EQ(loaded.problems, "");
  EXPECT_FALSE(loaded.robot.axes.at(0).limits.lower.has_value());
  EXPECT_EQ(loaded.robot.axes.at(0).limits.velocity, 3.0);
  EXPECT_THAT(loaded.robot.warnings,
              ElementsAre(HasSubstr("lower -1 of urdf does not count, as the joint is `type: "
                                    "continuous`"),
                          HasSubstr("upper 1 of urdf")));
}

/// Axes m5 and m6 that turn pitch and roll; one of them has a joint's name.
LoadedRobot differential(const std::string& limits_from) {
  return loadText(
      "bus: {interface: can0}\nlimits_from: {" + limits_from +
      "}\ndefaults: {drive: generic_cia402, counts_per_turn: 4000, limits: {velocity: 3.0, "
      "acceleration: 12.0}}\naxes:\n  pitch: {node_id: 1}\n  m6: {node_id: 2}\ncouplings: "
      "[{joints: [pitch, roll], axes: [pitch, m6], matrix: [[0.5, 0.5], [1, -1]], "
      "pitch: {limits: {lower: -1, upper: 1, velocity: 2, acceleration: 8}}, "
      "roll: {type: continuous, limits: {velocity: 2, acceleration: 8}}}]\n");
}

TEST(DescribedLimits, OfACoupledJointAreNotThoseOfAnAxis) {
  const LoadedRobot loaded =
      differential("urdf: {pitch: {velocity: 0.5, effort: 3}}, joint_limits: {pitch: {jerk: 60}}");
  EXPECT_EQ(loaded.problems, "");
  EXPECT_EQ(loaded.robot.axes.at(0).limits.velocity, 3.0);
  ASSERT_THAT(loaded.robot.couplings, SizeIs(1));
  const motion::JointLimits& limits = loaded.robot.couplings[0].joints[0].limits;
  EXPECT_EQ(limits.velocity, 0.5);
  EXPECT_EQ(limits.upper, 1.0);
  EXPECT_FALSE(limits.effort.has_value());
  EXPECT_FALSE(limits.jerk.has_value());
  EXPECT_THAT(
      loaded.robot.warnings,
      ElementsAre(HasSubstr("not 2 of couplings[0]/pitch/limits"),
                  "pitch: jerk 60 of joint_limits, effort 3 of urdf do not count, as several "
                  "axes move the joint: limit these instead (axes/<name>/limits)"));
}

TEST(DescribedLimits, AReloadSeesWhatTheyChange) {
  const auto settled = [](const std::string& text) {
    return settledTree(YAML::Load(text), loadText(text).robot);
  };
  const std::vector<Change> changes =
      changesOf(settled(armWith("urdf: {elbow: {velocity: 1.0}}")),
                settled(armWith("urdf: {elbow: {velocity: 1.5}, shoulder: {velocity: 9}}")));
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(changes[0].key, "axes/elbow/limits/velocity");
  EXPECT_EQ(changes[0].before, "1");
  EXPECT_EQ(changes[0].after, "1.5");
  EXPECT_EQ(changes[0].when, ChangeTime::disabled);
}

TEST(DescribedLimits, WhatIsSettledLoadsAsBefore) {
  const std::string text = armWith("urdf: {elbow: {velocity: 1.0, jerk: 7}}");
  const LoadedRobot loaded = loadText(text);
  Problems problems;
  const RobotConfig again = loadRobot(settledTree(YAML::Load(text), loaded.robot),
                                      profilesIn({test::configFolder() + "/drives"}), problems);
  EXPECT_EQ(problems.text(), "");
  EXPECT_EQ(again.axes.at(1).limits.velocity, 1.0);
  EXPECT_EQ(again.axes.at(1).limits.jerk, 7.0);
  EXPECT_EQ(again.axes.at(0).limits.upper, 3.0);
  EXPECT_THAT(again.warnings, IsEmpty());
}

}  // namespace
}  // namespace cia402::config
