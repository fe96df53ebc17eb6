// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What users of ros_controllers' joint_trajectory_controller know of stamps, rest and stops.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "bus/group_scene.h"

namespace cia402::bus {
namespace {

using motion::TrajectoryErrorCode;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;
using test::Outcomes;

constexpr Duration kSeenToRest = 100ms;  // at most, until a motor that stands is known to

struct LikeJtc : test::GroupScene {
  using GroupScene::GroupScene;
  Outcomes sendPoints(const std::vector<RobotWorld::Point>& points,
                      std::optional<Duration> stamp = {}) {
    TrajectoryCommand command = world.trajectory("arm", points);
    if (stamp) command.start_time = world.now + *stamp;
    command.id = 1;
    return send(std::move(command));
  }
};

TEST_F(LikeJtc, ATrajectoryWhoseTimeIsOverLeavesTheOneThatRuns) {
  const Outcomes first = sendPoints({{{1.0, -0.5}, 1.0}});
  world.run(300ms);
  sendPoints({{{0.2, 0.2}, 1.0}, {{0.4, 0.4}, 2.0}}, -3s);
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.code, TrajectoryErrorCode::invalid_goal);
  EXPECT_THAT(answer.message, HasSubstr("all points have passed"));
  world.run(900ms);
  ASSERT_EQ(first->size(), 1u);
  EXPECT_EQ(first->front().end, TrajectoryEnd::reached);
  EXPECT_EQ(position(0), 100000);
}

TEST_F(LikeJtc, OfOneThatBeganInThePastOnlyWhatIsAheadIsFollowedAndThatIsTold) {
  const Outcomes ended =
      sendPoints({{{-1.0, 1.0}, 0.2}, {{-1.0, 1.0}, 0.5}, {{0.4, 0.2}, 1.5}}, -500ms);
  EXPECT_TRUE(answer.success);
  EXPECT_EQ(answer.passed_points, 2u);
  EXPECT_EQ(answer.message,
            "arm: trajectory accepted without the first 2 of 3 points, whose time has passed: it "
            "was to begin 0.5 s ago");
  world.run(500ms);
  EXPECT_NEAR(world.drives[0].radians(), 0.2, 0.02) << "halfway, after half of the second left";
  world.run(600ms);
  EXPECT_EQ(position(0), 40000);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::reached);
}

// MoveIt's first point is where the robot stands.
TEST_F(LikeJtc, AtStampZeroAPointAtTheBeginningIsNotWorthAWord) {
  sendPoints({{{0.0, 0.0}, 0.0}, {{0.4, 0.2}, 1.0}});
  EXPECT_TRUE(answer.success);
  EXPECT_EQ(answer.passed_points, 0u);
  EXPECT_EQ(answer.message, "arm: trajectory accepted");
  world.run(1100ms);
  EXPECT_EQ(position(0), 40000);
}

TEST_F(LikeJtc, PointsBeforeTheStartHavePassed) {
  sendPoints({{{-1.0, 1.0}, -0.5}, {{0.4, 0.2}, 1.0}});
  EXPECT_TRUE(answer.success) << answer.message;
  world.run(1100ms);
  EXPECT_EQ(position(0), 40000);
  sendPoints({{{-1.0, 1.0}, -0.5}});
  EXPECT_EQ(answer.code, TrajectoryErrorCode::invalid_goal);
}

struct TurningShoulder : LikeJtc {
  TurningShoulder() : LikeJtc(robot()) {}
  static config::RobotConfig robot() {
    config::RobotConfig config = test::testRobot();
    config.axes[0].geometry.type = drive::AxisGeometry::Type::continuous;
    config.axes[0].limits.lower.reset();
    config.axes[0].limits.upper.reset();
    return config;
  }
};

/// JTC's `wraparoundJointOffset`: where both ways are half a turn, the one towards the point.
TEST_F(TurningShoulder, HalfATurnGoesTheWayThatWasAsked) {
  for (const double goal : {M_PI, 0.0, -M_PI, 0.0}) {
    sendPoints({{{goal, 0.0}, 4.0}});
    world.run(4100ms);
    EXPECT_NEAR(world.drives[0].radians(), goal, 1e-4);
  }
  sendPoints({{{-0.5 * M_PI, 0.0}, 4.0}});
  world.run(4100ms);
  sendPoints({{{0.5 * M_PI, 0.0}, 4.0}});
  world.run(4100ms);
  EXPECT_NEAR(world.drives[0].radians(), 0.5 * M_PI, 1e-4);
}

TEST_F(TurningShoulder, OneTurnAndAHalfIsHalfATurnTheSameWay) {
  sendPoints({{{3.0 * M_PI, 0.0}, 4.0}});
  world.run(4100ms);
  EXPECT_NEAR(world.drives[0].radians(), M_PI, 1e-4);
  sendPoints({{{-2.0 * M_PI, 0.0}, 4.0}});
  world.run(4100ms);
  EXPECT_NEAR(world.drives[0].radians(), 0.0, 1e-4);
}

TEST_F(TurningShoulder, MoreThanHalfATurnGoesTheOtherWay) {
  sendPoints({{{1.5 * M_PI, 0.0}, 4.0}});
  world.run(4100ms);
  EXPECT_NEAR(world.drives[0].radians(), -0.5 * M_PI, 1e-4);
}

TEST_F(TurningShoulder, OnlyTheFirstPointIsTakenTheShorterWay) {
  sendPoints({{{1.5 * M_PI, 0.0}, 4.0}, {{3.5 * M_PI, 0.0}, 12.0}});
  world.run(12100ms);
  EXPECT_NEAR(world.drives[0].radians(), 1.5 * M_PI, 1e-4) << "a whole turn on from there";
}

struct RestTest : LikeJtc {
  explicit RestTest(double tolerance = 0.01) : LikeJtc(robot(tolerance)) {}
  static config::RobotConfig robot(double tolerance) {
    config::RobotConfig config = test::testRobot();
    config.groups[0].stopped_velocity_tolerance = tolerance;
    config.groups[0].tolerances["elbow"].goal = 0.05;
    return config;
  }
  /// The elbow's motor swings about its set-point by so many counts (100000 are one rad): by 1000
  /// with 5 rad/s, 0.02 rad in each cycle of 4 ms.
  void swing(int counts, Duration duration) {
    for (const Time end = world.now + duration; world.now < end; world.run(test::kPeriod)) {
      world.drives[1].disturbance = world.drives[1].disturbance > 0 ? -counts : counts;
    }
  }
};

TEST_F(RestTest, AGoalIsReachedOnceTheMotorStands) {
  const Outcomes ended = sendPoints({{{0.5, 0.5}, 1.0}});
  world.run(900ms);
  swing(1000, 300ms);  // within the tolerance of its goal
  EXPECT_TRUE(ended->empty());
  world.drives[1].disturbance = 0;
  world.run(100ms);
  ASSERT_EQ(ended->size(), 1u) << "at most 0.1 s after it stands";
  EXPECT_EQ(ended->front().end, TrajectoryEnd::reached);
}

TEST_F(RestTest, AMotorThatGoesOnMovingHasMissedItsGoal) {
  const Outcomes ended = sendPoints({{{0.5, 0.5}, 1.0}});
  world.run(900ms);
  swing(1000, 600ms);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::failed);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::goal_tolerance_violated);
  EXPECT_EQ(ended->front().joint, "elbow");
  EXPECT_EQ(
      ended->front().message,
      "arm: goal missed: elbow still moves at 5 rad/s 0.4 s after the end, its "
      "stopped_velocity_tolerance is 0.01 rad/s; see whether it swings or is pushed, or give a "
      "larger goal_time or tolerance");
}

TEST_F(RestTest, OneUnitOfTheEncoderToAndFroIsRest) {
  const Outcomes ended = sendPoints({{{0.5, 0.5}, 1.0}});
  world.run(900ms);
  swing(1, 200ms);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::reached);
}

TEST_F(RestTest, WhatIsCancelledEndsOnceTheMotorsStand) {
  const Outcomes ended = sendPoints({{{0.5, 0.5}, 1.0}});
  world.run(500ms);
  ASSERT_TRUE(world.call(CancelCommand{"arm", 1}).success);
  world.run(60ms);  // of its ramp of 75 ms
  swing(1000, 200ms);
  EXPECT_TRUE(ended->empty()) << "the set-points are at rest, a motor is not";
  world.drives[1].disturbance = 0;
  world.run(kSeenToRest);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::stopped);
  EXPECT_EQ(ended->front().message, "arm: cancelled");
}

TEST_F(RestTest, WhatIsCancelledEndsAllTheSameWhereAMotorDoesNotComeToRest) {
  const Outcomes ended = sendPoints({{{0.5, 0.5}, 1.0}});
  world.run(500ms);
  ASSERT_TRUE(world.call(CancelCommand{"arm", 1}).success);
  world.run(60ms);
  swing(1000, 600ms);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::stopped);
  EXPECT_EQ(ended->front().message,
            "arm: cancelled, but elbow still moves at 5 rad/s, its stopped_velocity_tolerance is "
            "0.01 rad/s; see whether it swings or is pushed");
}

// A halt takes the joint from the trajectory; the motor does not stand for that.
TEST_F(RestTest, WhatIsHaltedEndsOnceTheMotorsStand) {
  const Outcomes ended = sendPoints({{{0.5, 0.5}, 1.0}});
  world.run(500ms);
  ASSERT_TRUE(world.call(CancelCommand{"arm", 1}).success);
  world.run(20ms);
  const auto halt = world.begin(drive::ProcedureKind::halt);
  swing(1000, 200ms);
  EXPECT_TRUE(ended->empty());
  world.drives[1].disturbance = 0;
  world.run(kSeenToRest);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::stopped);
}

struct NoRestTest : RestTest {
  NoRestTest() : RestTest(0.0) {}
};

TEST_F(NoRestTest, WithoutTheToleranceRestIsNotWaitedFor) {
  const Outcomes ended = sendPoints({{{0.5, 0.5}, 1.0}});
  world.run(900ms);
  swing(1000, 120ms);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::reached);
}

struct GentleStop : LikeJtc {
  GentleStop() : LikeJtc(robot()) {}
  static config::RobotConfig robot() {
    config::RobotConfig config = test::testRobot();
    config.groups[0].stop_trajectory_duration = 0.6;
    config.groups[0].allow_partial_joints_goal = true;
    return config;
  }
  /// Until the shoulder is fastest, 1.5 rad/s: its limit of 10 rad/s² would stop it in 0.15 s.
  Outcomes start() {
    const Outcomes ended = sendPoints({{{1.0, -0.5}, 1.0}});
    world.run(500ms);
    return ended;
  }
  double speed() const { return std::abs(world.group().commanded()[0].velocity); }
};

TEST_F(GentleStop, ACancelledTrajectoryTakesItsTimeToStop) {
  const Outcomes ended = start();
  const int from = position(0);
  ASSERT_TRUE(world.call(CancelCommand{"arm", 1}).success);
  world.run(300ms);
  EXPECT_NEAR(speed(), 0.75, 0.03);
  EXPECT_TRUE(ended->empty());
  world.run(320ms + kSeenToRest);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::stopped);
  EXPECT_NEAR(position(0) - from, 45000, 1500);  // 1.5 rad/s * 0.6 s / 2
}

TEST_F(GentleStop, SoDoesAJointThatIsStoppedAlone) {
  start();
  TrajectoryCommand stop = world.trajectory("arm", {});
  stop.joints = {"elbow"};
  const Outcomes ended = send(std::move(stop));
  world.run(300ms);
  EXPECT_NEAR(world.group().commanded()[1].velocity, -0.375, 0.02);
  EXPECT_TRUE(ended->empty());
  world.run(320ms + kSeenToRest);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().message, "arm: stands");
}

TEST_F(GentleStop, AFaultStopsTheOthersAsHardAsTheyMay) {
  const Outcomes ended = start();
  world.drives[1].fault(0x8611);
  world.run(10ms);
  ASSERT_EQ(ended->size(), 1u) << "told as the stop begins";
  EXPECT_EQ(ended->front().end, TrajectoryEnd::failed);
  EXPECT_TRUE(world.group().stopping());
  world.run(170ms);
  EXPECT_EQ(speed(), 0.0);
  world.run(kSeenToRest);
  EXPECT_FALSE(world.group().stopping());
}

TEST_F(GentleStop, WhatStopsAllMotionHastensIt) {
  start();
  ASSERT_TRUE(world.call(CancelCommand{"arm", 1}).success);
  world.run(100ms);
  EXPECT_GT(speed(), 1.1);
  world.network.cycle().groups()[0].stop({TrajectoryErrorCode::path_tolerance_violated, "bus off"});
  world.run(140ms);
  EXPECT_EQ(speed(), 0.0);
}

}  // namespace
}  // namespace cia402::bus
