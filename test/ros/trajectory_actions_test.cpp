// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/trajectory_actions.h"

#include <control_msgs/FollowJointTrajectoryGoal.h>
#include <control_msgs/JointTolerance.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace cia402::ros_node {
namespace {

using control_msgs::FollowJointTrajectoryGoal;
using testing::IsEmpty;
using testing::Optional;
using testing::SizeIs;

config::GroupConfig armGroup() {
  config::GroupConfig group;
  group.name = "arm";
  group.joints = {"shoulder", "elbow"};
  return group;
}

control_msgs::JointTolerance toleranceOf(const std::string& joint, double position) {
  control_msgs::JointTolerance tolerance;
  tolerance.name = joint;
  tolerance.position = position;
  return tolerance;
}

// control_msgs/JointTolerance: 0 leaves the default, -1 erases it.
TEST(TolerancesOfAGoal, NoneLeaveThoseOfTheGroup) {
  const bus::TrajectoryTolerances tolerances =
      tolerancesOf(FollowJointTrajectoryGoal(), armGroup());
  EXPECT_THAT(tolerances.joints, IsEmpty());
  EXPECT_FALSE(tolerances.goal_time.has_value());
}

TEST(TolerancesOfAGoal, OfThePathAndOfTheGoalAreKeptApart) {
  FollowJointTrajectoryGoal goal;
  goal.path_tolerance = {toleranceOf("shoulder", 0.1)};
  goal.goal_tolerance = {toleranceOf("shoulder", 0.02), toleranceOf("elbow", 0.03)};
  const bus::TrajectoryTolerances tolerances = tolerancesOf(goal, armGroup());
  ASSERT_THAT(tolerances.joints, SizeIs(2));
  EXPECT_THAT(tolerances.joints.at("shoulder").trajectory, Optional(0.1));
  EXPECT_THAT(tolerances.joints.at("shoulder").goal, Optional(0.02));
  EXPECT_FALSE(tolerances.joints.at("elbow").trajectory.has_value());
  EXPECT_THAT(tolerances.joints.at("elbow").goal, Optional(0.03));
}

TEST(TolerancesOfAGoal, ZeroLeavesThatOfTheGroup) {
  FollowJointTrajectoryGoal goal;
  goal.path_tolerance = {toleranceOf("shoulder", 0.0)};
  goal.goal_tolerance = {toleranceOf("shoulder", 0.0)};
  const bus::TrajectoryTolerances tolerances = tolerancesOf(goal, armGroup());
  const auto shoulder = tolerances.joints.find("shoulder");
  if (shoulder == tolerances.joints.end()) return;
  EXPECT_FALSE(shoulder->second.trajectory.has_value());
  EXPECT_FALSE(shoulder->second.goal.has_value());
}

TEST(TolerancesOfAGoal, NegativeOnesAreNotChecked) {
  FollowJointTrajectoryGoal goal;
  goal.path_tolerance = {toleranceOf("elbow", -1.0)};
  goal.goal_tolerance = {toleranceOf("elbow", -0.001)};
  const bus::TrajectoryTolerances tolerances = tolerancesOf(goal, armGroup());
  // 0 is what a group has that checks nothing (docs/configuration.md).
  EXPECT_THAT(tolerances.joints.at("elbow").trajectory, Optional(0.0));
  EXPECT_THAT(tolerances.joints.at("elbow").goal, Optional(0.0));
}

TEST(TolerancesOfAGoal, NamesThatTheGroupHasNotAreIgnored) {
  FollowJointTrajectoryGoal goal;
  goal.path_tolerance = {toleranceOf("knee", 0.1)};
  goal.goal_tolerance = {toleranceOf("", 0.1), toleranceOf("knee", -1.0)};
  EXPECT_THAT(tolerancesOf(goal, armGroup()).joints, IsEmpty());
}

TEST(TolerancesOfAGoal, VelocitiesAndAccelerationsDoNotCount) {
  FollowJointTrajectoryGoal goal;
  goal.path_tolerance = {toleranceOf("shoulder", 0.0)};
  goal.path_tolerance[0].velocity = 0.1;
  goal.path_tolerance[0].acceleration = -1.0;
  const bus::TrajectoryTolerances tolerances = tolerancesOf(goal, armGroup());
  EXPECT_FALSE(tolerances.joints.count("shoulder") > 0 &&
               tolerances.joints.at("shoulder").trajectory.has_value());
}

TEST(TolerancesOfAGoal, TheTimeIsThatOfTheGoalWhereItHasOne) {
  FollowJointTrajectoryGoal goal;
  goal.goal_time_tolerance = ros::Duration(0.75);
  EXPECT_THAT(tolerancesOf(goal, armGroup()).goal_time, Optional(0.75));
  goal.goal_time_tolerance = ros::Duration(-1.0);
  EXPECT_THAT(tolerancesOf(goal, armGroup()).goal_time, Optional(0.0));
  goal.goal_time_tolerance = ros::Duration(0.0);
  EXPECT_FALSE(tolerancesOf(goal, armGroup()).goal_time.has_value());
}

}  // namespace
}  // namespace cia402::ros_node
