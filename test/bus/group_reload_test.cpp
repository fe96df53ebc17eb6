// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Tolerances and times of a group that change while a trajectory is followed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/canopen/reload_command.h"
#include "bus/group_scene.h"

namespace cia402::bus {
namespace {

using motion::TrajectoryErrorCode;
using test::Outcomes;
using testing::HasSubstr;
using namespace std::chrono_literals;

struct GroupReload : test::GroupScene {
  /// The group gets what `change` makes of its configuration.
  template <typename Change>
  void reload(Change change) {
    const config::RobotConfig now = test::testRobot();
    change(next.groups[0]);
    const canopen::MasterConfig master = test::masterOf(now);
    ASSERT_TRUE(
        world.call(ReloadCommand{makeReload({now, master}, {next, master}, false)}).success);
  }
  TrajectoryCommand toOneRadian() { return world.trajectory("arm", {{{1.0, -1.0}, 1.0}}); }
  config::RobotConfig next = test::testRobot();
};

TEST_F(GroupReload, APathToleranceCountsAtOnce) {
  const Outcomes ended = send(toOneRadian());
  world.run(500ms);
  world.drives[1].disturbance = 20000;
  world.run(20ms);
  ASSERT_TRUE(ended->empty()) << "nothing is checked";
  reload([](config::GroupConfig& group) { group.tolerances["elbow"].trajectory = 0.1; });
  world.run(8ms);
  ASSERT_EQ(ended->size(), 1U);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::path_tolerance_violated);
  EXPECT_THAT(ended->front().message, HasSubstr("elbow is 0.2"));
  expectSmooth(0);
  world.run(500ms);
  const int stopped = position(0);
  world.run(500ms);
  EXPECT_EQ(position(0), stopped);
  EXPECT_LT(stopped, 90000) << "it goes on to its goal";
}

TEST_F(GroupReload, AGoalToleranceCountsForWhatIsUnderWay) {
  world.drives[1].disturbance = 5000;
  const Outcomes ended = send(toOneRadian());
  world.run(500ms);
  reload([](config::GroupConfig& group) { group.tolerances["elbow"].goal = 0.02; });
  world.run(1500ms);
  ASSERT_EQ(ended->size(), 1U);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::goal_tolerance_violated);
  EXPECT_THAT(ended->front().message, HasSubstr("the tolerance is 0.02"));
}

TEST_F(GroupReload, AWiderOneLetsAGoalBeReachedThatIsAwaited) {
  world.drives[1].disturbance = 5000;
  reload([](config::GroupConfig& group) {
    group.tolerances["elbow"].goal = 0.02;
    group.goal_time = 10.0;
  });
  const Outcomes ended = send(toOneRadian());
  world.run(2s);
  ASSERT_TRUE(ended->empty()) << "it is waited for";
  reload([](config::GroupConfig& group) { group.tolerances["elbow"].goal = 0.06; });
  world.run(100ms);
  ASSERT_EQ(ended->size(), 1U);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::reached);
}

TEST_F(GroupReload, LessTimeEndsTheWait) {
  world.drives[1].disturbance = 5000;
  reload([](config::GroupConfig& group) {
    group.tolerances["elbow"].goal = 0.02;
    group.goal_time = 10.0;
  });
  const Outcomes ended = send(toOneRadian());
  world.run(2s);
  reload([](config::GroupConfig& group) { group.goal_time = 0.5; });
  world.run(8ms);
  ASSERT_EQ(ended->size(), 1U);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::goal_tolerance_violated);
}

TEST_F(GroupReload, WhatAGoalHasOfItsOwnStays) {
  world.drives[1].disturbance = 5000;
  TrajectoryCommand command = toOneRadian();
  command.tolerances.joints["elbow"].goal = 0.06;
  command.tolerances.goal_time = 2.0;
  const Outcomes ended = send(command);
  world.run(500ms);
  reload([](config::GroupConfig& group) {
    group.tolerances["elbow"] = {0.5, 0.02};
    group.goal_time = 0.1;
  });
  world.run(2s);
  ASSERT_EQ(ended->size(), 1U);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::reached);
}

TEST_F(GroupReload, ButOnlyThat) {
  TrajectoryCommand command = toOneRadian();
  command.tolerances.joints["elbow"].goal = 3.0;
  const Outcomes ended = send(command);
  world.run(500ms);
  world.drives[1].disturbance = 20000;
  reload([](config::GroupConfig& group) { group.tolerances["elbow"].trajectory = 0.1; });
  world.run(8ms);
  ASSERT_EQ(ended->size(), 1U);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::path_tolerance_violated);
  EXPECT_THAT(ended->front().message, HasSubstr("the tolerance is 0.1"));
}

TEST_F(GroupReload, TrajectoriesForSomeJointsAreTakenFromThenOn) {
  TrajectoryCommand command = world.trajectory("arm", {{{0.5}, 1.0}});
  command.joints = {"elbow"};
  ASSERT_FALSE(world.call(command).success);
  reload([](config::GroupConfig& group) { group.allow_partial_joints_goal = true; });
  EXPECT_TRUE(world.call(command).success);
}

TEST_F(GroupReload, ACancelledTrajectoryStopsAsGentlyAsIsSaidByThen) {
  TrajectoryCommand command = toOneRadian();
  command.id = 7;
  send(command);
  world.run(500ms);
  const int before = position(0);
  reload([](config::GroupConfig& group) { group.stop_trajectory_duration = 0.5; });
  ASSERT_TRUE(world.call(CancelCommand{"arm", 7}).success);
  world.run(1s);
  // From 1.5 rad/s in 0.5 s: 0.375 rad; with 10 rad/s² it would be 0.11.
  EXPECT_NEAR(position(0) - before, 37500, 1500);
}

}  // namespace
}  // namespace cia402::bus
