// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a URDF, and joint_limits of MoveIt and ros_control, say of the limits of joints.
#include "ros/described_limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::ros_node {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A chain of one joint of that type and its <limit>.
std::string urdfOf(const std::string& type, const std::string& limit) {
  return "<robot name='r'><link name='a'/><link name='b'/><joint name='elbow' type='" + type +
         "'><parent link='a'/><child link='b'/>" + limit + "</joint></robot>";
}

struct Read {
  YAML::Node limits;
  Problems problems;
  std::vector<std::string> warnings;

  std::string of(const std::string& key) const {
    const YAML::Node joint = limits["elbow"];
    return joint && joint[key] ? joint[key].Scalar() : "none";
  }
};

Read urdf(const std::string& text, const std::vector<std::string>& joints = {"elbow"}) {
  Read read;
  read.limits = limitsOfUrdf(text, "robot_description", joints, read.problems, read.warnings);
  return read;
}

Read jointLimits(const std::string& yaml) {
  Read read;
  read.limits = limitsOfJointLimits(YAML::Load(yaml), "joint_limits", {"elbow"}, read.problems,
                                    read.warnings);
  return read;
}

TEST(LimitsOfUrdf, AreThoseOfTheJointsThatAreAskedFor) {
  const std::string text =
      urdfOf("revolute", "<limit lower='-1.25' upper='2.5' velocity='1.5' effort='40'/>");
  const Read read = urdf(text);
  EXPECT_EQ(read.of("lower"), "-1.25");
  EXPECT_EQ(read.of("upper"), "2.5");
  EXPECT_EQ(read.of("velocity"), "1.5");
  EXPECT_EQ(read.of("effort"), "40");
  EXPECT_THAT(read.warnings, IsEmpty());
  EXPECT_EQ(urdf(text, {"wrist"}).limits.size(), 0U);
}

TEST(LimitsOfUrdf, ZerosCountAsNotGivenWithAWarning) {
  const Read read =
      urdf(urdfOf("prismatic", "<limit lower='0' upper='0' velocity='0' effort='0'/>"));
  EXPECT_EQ(read.limits.size(), 0U);
  EXPECT_THAT(read.warnings,
              ElementsAre(AllOf(HasSubstr("robot_description: joint elbow: velocity 0 counts as "
                                          "not given")),
                          HasSubstr("effort 0 counts as not given"),
                          HasSubstr("positions from 0 to 0 count as not given")));
}

TEST(LimitsOfUrdf, OfAJointWithoutEndAreNoneOfPosition) {
  const Read read = urdf(urdfOf("continuous", "<limit velocity='3' effort='7'/>"));
  EXPECT_EQ(read.of("velocity"), "3");
  EXPECT_EQ(read.of("lower"), "none");
  EXPECT_THAT(read.warnings, IsEmpty());
  EXPECT_EQ(urdf(urdfOf("continuous", "")).limits.size(), 0U);
}

TEST(LimitsOfUrdf, WhatIsNoUrdfIsAProblem) {
  for (const char* text : {"", "elbow", "<robot>", "<robot name='r'/>"}) {
    EXPECT_THAT(urdf(text).problems.text(), HasSubstr("robot_description: is no URDF")) << text;
  }
}

TEST(LimitsOfJointLimits, AreThoseThatItHas) {
  const Read read = jointLimits(
      "{elbow: {has_velocity_limits: true, max_velocity: 2, has_acceleration_limits: true, "
      "max_acceleration: 3.5, has_jerk_limits: false, max_jerk: 7, has_effort_limits: true, "
      "max_effort: 11, has_position_limits: true, min_position: -1, max_position: 1.5}, other: 3}");
  EXPECT_EQ(read.of("velocity"), "2");
  EXPECT_EQ(read.of("acceleration"), "3.5");
  EXPECT_EQ(read.of("jerk"), "none");
  EXPECT_EQ(read.of("effort"), "11");
  EXPECT_EQ(read.of("lower"), "-1");
  EXPECT_EQ(read.of("upper"), "1.5");
  EXPECT_TRUE(read.problems.empty());
  EXPECT_THAT(read.warnings, IsEmpty());
}

TEST(LimitsOfJointLimits, WhatIsMissingOrNoLimitIsToldAndDoesNotLimit) {
  const Read read = jointLimits(
      "{elbow: {has_velocity_limits: true, has_acceleration_limits: true, max_acceleration: 0, "
      "has_position_limits: true, max_position: 1}}");
  EXPECT_EQ(read.limits.size(), 0U);
  EXPECT_THAT(read.warnings,
              ElementsAre(HasSubstr("joint_limits: joint elbow: has velocity limits, but no "
                                    "max_velocity"),
                          HasSubstr("acceleration 0 counts as not given"),
                          HasSubstr("not both of min_position and max_position")));
}

TEST(LimitsOfJointLimits, WhatIsNoNumberIsAProblem) {
  EXPECT_THAT(
      jointLimits("{elbow: {has_velocity_limits: true, max_velocity: fast}}").problems.text(),
      HasSubstr("joint_limits/elbow/max_velocity: must be a number"));
  EXPECT_THAT(jointLimits("{elbow: {has_jerk_limits: perhaps, max_jerk: 1}}").problems.text(),
              HasSubstr("joint_limits/elbow/has_jerk_limits: must be true or false"));
  EXPECT_TRUE(jointLimits("[1, 2]").problems.empty());
}

TEST(JointNames, AreThoseOfAxesAndCouplings) {
  EXPECT_THAT(jointNamesIn(YAML::Load("{axes: {m1: {joint: shoulder}, elbow: {}, x: 3}, couplings: "
                                      "[{joints: [pitch, roll], axes: [a, b]}, 4]}")),
              ElementsAre("shoulder", "elbow", "x", "pitch", "roll"));
  EXPECT_THAT(jointNamesIn(YAML::Load("{axes: [1], couplings: {a: 1}}")), IsEmpty());
}

}  // namespace
}  // namespace cia402::ros_node
