// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "motion/trajectory_fixture.h"

namespace cia402::motion {
namespace {

using Code = TrajectoryErrorCode;

class TrajectoryChecks : public TrajectoryFixture {};

TEST_F(TrajectoryChecks, CodesAreThoseOfFollowJointTrajectory) {
  EXPECT_EQ(static_cast<int>(Code::successful), 0);
  EXPECT_EQ(static_cast<int>(Code::invalid_goal), -1);
  EXPECT_EQ(static_cast<int>(Code::invalid_joints), -2);
  EXPECT_EQ(static_cast<int>(Code::old_header_timestamp), -3);
  EXPECT_EQ(static_cast<int>(Code::path_tolerance_violated), -4);
  EXPECT_EQ(static_cast<int>(Code::goal_tolerance_violated), -5);
}

TEST_F(TrajectoryChecks, SizesMustBeThatOfTheJoints) {
  expectInvalid({point(1, {1, 2}), point(2, {1})},
                "point 1 has 1 positions where the trajectory has 2 joints (shoulder to lift)");
  expectInvalid({point(1, {})}, "point 0 has 0 positions");
  expectInvalid({point(1, {1, 2}, {0, 0, 0})}, "point 0 has 3 velocities");
  expectInvalid({point(1, {1, 2}, {0, 0}, {0})}, "point 0 has 1 accelerations");
}

TEST_F(TrajectoryChecks, EveryValueMustBeFinite) {
  expectInvalid({point(1, {1, 2}), point(2, {1, kNan})},
                "lift: point 1 has nan among its positions");
  expectInvalid({point(1, {1, 2}, {INFINITY, 0})},
                "shoulder: point 0 has inf among its velocities");
  expectInvalid({point(1, {1, 2}, {0, 0}, {0, -INFINITY})},
                "lift: point 0 has -inf among its accelerations");
}

TEST_F(TrajectoryChecks, PointsThatHavePassedAreCheckedForSense) {
  start.start_time = at(-5);
  expectInvalid({point(1, {kNan, 2}), point(6, {1, 2})}, "shoulder: point 0 has nan");
}

TEST_F(TrajectoryChecks, AccelerationsNeedVelocities) {
  expectInvalid({point(1, {1, 2}, {}, {0, 0})}, "point 0 has accelerations without velocities");
}

TEST_F(TrajectoryChecks, TimesMustRise) {
  expectInvalid({point(-0.5, {1, 2})}, "point 0, the only one, has time_from_start -0.5 s");
  expectInvalid({point(-2, {1, 2}), point(0, {1, 2})},
                "point 1, the last one, has time_from_start 0 s: there is no time to reach it in");
  expectInvalid({point(1, {1, 2}), point(1, {1, 2})},
                "point 1 has time_from_start 1 s, which is not after the 1 s of point 0");
  expectInvalid({point(2, {1, 2}), point(1, {1, 2})}, "point 1 has time_from_start 1 s");
  expectInvalid({point(0, {1, 2})}, "point 0, the only one, has time_from_start 0 s");
}

TEST_F(TrajectoryChecks, TimesBeyondTheEndOfTimeAreRefused) {
  TrajectoryPoint late = point(0, {1, 2});
  late.time_from_start = Duration::max();
  expectInvalid({late}, "point 0 lies beyond the end of time");
}

TEST_F(TrajectoryChecks, MustEndAtRest) {
  expectInvalid({point(1, {1, 2}, {0, 0}), point(2, {1, 2}, {0, 0.2})},
                "lift: the last point (point 1) has velocity 0.2 m/s; it must be 0");
  expectInvalid({point(1, {1, 2}, {-0.3, 0})}, "velocity -0.3 rad/s");
  EXPECT_TRUE(create({point(1, {1, 2}, {0.001, -0.001})}).ok()) << "so much counts as rest";
  expectInvalid({point(1, {1, 2}, {0.00101, 0})}, "velocity 0.00101 rad/s");
}

TEST_F(TrajectoryChecks, ThePresentStateMustBeKnownForEachJoint) {
  commanded[1].position = kNan;
  expectInvalid({point(1, {1, 2})}, "lift: its present position or velocity is unknown");
  commanded.pop_back();
  expectRefused({point(1, {1, 2})}, Code::invalid_joints, "the present state has 1 joints");
  joints.clear();
  expectRefused({}, Code::invalid_joints, "no joints");
}

TEST_F(TrajectoryChecks, PointsThatLieBeforeTheStartHavePassed) {
  const auto trajectory = create({point(-1, {9, 9}), point(0, {8, 8}), point(1, {1, 2})});
  ASSERT_TRUE(trajectory.ok()) << trajectory.error().message;
  EXPECT_EQ(trajectory->droppedPoints(), 2U);
  start.start_time = at(5);
  const auto ahead = create({point(-1, {0.5, 1}), point(1, {1, 2})});
  ASSERT_TRUE(ahead.ok()) << ahead.error().message;
  EXPECT_EQ(ahead->droppedPoints(), 1U) << "it begins no sooner than it is stamped";
}

TEST_F(TrajectoryChecks, AllPointsPassedIsRefused) {
  start.start_time = at(-10);
  expectRefused({point(1, {1, 2}), point(10, {1, 2})}, Code::invalid_goal,
                "should have begun 10 s ago and its last point is at 10 s");
}

TEST_F(TrajectoryChecks, PositionLimitsHoldAtThePoints) {
  joints[0].limits.upper = 3.1;
  joints[1].limits.lower = -0.2;
  expectInvalid({point(1, {1, 0}), point(2, {3.2, 0})},
                "shoulder: on the way from point 0 to point 1, at 2 s, the position reaches 3.2 "
                "rad, beyond the upper limit 3.1 rad");
  expectInvalid({point(1, {1, -0.3})},
                "lift: on the way from the present state to point 0, at 1 s, the position reaches "
                "-0.3 m, beyond the lower limit -0.2 m");
  EXPECT_TRUE(create({point(1, {3.1, -0.2})}).ok());
}

TEST_F(TrajectoryChecks, PositionLimitsHoldBetweenThePoints) {
  // leaves 0 at 1 rad/s and returns: peaks with 4/27 at 1/3 s
  commanded[0].velocity = 1;
  joints[0].limits.upper = 0.148;
  expectInvalid({point(1, {0, 0}, {0, 0})},
                "shoulder: on the way from the present state to point 0, at 0.33333333 s, the "
                "position reaches 0.14814815 rad, beyond the upper limit 0.148 rad");
  joints[0].limits.upper = 0.1482;
  EXPECT_TRUE(create({point(1, {0, 0}, {0, 0})}).ok());
}

TEST_F(TrajectoryChecks, AJointOutsideItsLimitsMayReturnButNotGoFurther) {
  joints[0].limits.lower = -3;
  joints[0].limits.upper = 3;
  commanded[0].position = 3.2;
  EXPECT_TRUE(create({point(1, {2, 0})}).ok());
  EXPECT_TRUE(create({point(1, {3.1, 0}), point(2, {2, 0})}).ok() == false);
  expectInvalid({point(1, {3.3, 0})}, "the position reaches 3.3 rad");
  commanded[0].position = -3.2;
  EXPECT_TRUE(create({point(1, {-2, 0})}).ok());
  expectInvalid({point(1, {-3.3, 0})}, "the position reaches -3.3 rad");
}

TEST_F(TrajectoryChecks, VelocityLimitHoldsBetweenThePoints) {
  joints[0].limits.velocity = 1.8;
  expectInvalid({point(1, {-1, 0}, {0, 0}, {0, 0})},
                "shoulder: on the way from the present state to point 0, at 0.5 s, the velocity "
                "reaches -1.875 rad/s, beyond the limit 1.8 rad/s");
  joints[0].limits.velocity = 1.875;
  EXPECT_TRUE(create({point(1, {-1, 0}, {0, 0}, {0, 0})}).ok());
}

TEST_F(TrajectoryChecks, AccelerationLimitHoldsBetweenThePoints) {
  joints[1].limits.acceleration = 5;
  // a cubic over 1 m in 1 s that arrives with 0.4 m/s begins with 6 - 2 * 0.4 = 5.2 m/s^2
  expectInvalid({point(1, {0, 0}, {0, 0}), point(2, {0, 1}, {0, 0.4}), point(9, {0, 1}, {0, 0})},
                "lift: on the way from point 0 to point 1, at 1 s, the acceleration reaches 5.2 "
                "m/s^2, beyond the limit 5 m/s^2");
  joints[1].limits.acceleration = 5.7735027;
  EXPECT_TRUE(create({point(1, {0, 1}, {0, 0}, {0, 0})}).ok());
}

TEST_F(TrajectoryChecks, AJumpToTheFirstPointIsTooFastFromThePresentState) {
  joints[0].limits.velocity = 2;
  commanded[0].position = -1;
  expectInvalid({point(0.1, {1, 0}), point(2, {2, 0})},
                "shoulder: on the way from the present state to point 0, at 0 s, the velocity "
                "reaches 20 rad/s, beyond the limit 2 rad/s");
}

TEST_F(TrajectoryChecks, LimitsAreCheckedFromThePresentStateWherePointsWereDropped) {
  joints[0].limits.velocity = 2;
  start.start_time = at(-1.5);
  expectInvalid({point(1, {1, 0}), point(2, {2, 0})},
                "on the way from the present state to point 1, at 1.5 s, the velocity reaches 4 "
                "rad/s");
}

TEST_F(TrajectoryChecks, ToleranceIsAMillionthOfTheLimit) {
  joints[0].limits.velocity = 1;
  EXPECT_TRUE(create({point(1, {1 + 0.5e-6, 0})}).ok());
  EXPECT_FALSE(create({point(1, {1 + 2e-6, 0})}).ok());
  joints[0].limits.velocity.reset();
  joints[0].limits.upper = 1;
  joints[0].limits.lower = 0;
  EXPECT_TRUE(create({point(1, {1 + 0.5e-6, 0})}).ok());
  EXPECT_FALSE(create({point(1, {1 + 2e-6, 0})}).ok());
}

TEST_F(TrajectoryChecks, AMotionTooFastToComputeIsRefusedWithoutAnyLimits) {
  expectInvalid({point(1e-9, {1e300, 0}, {0, 0})},
                "shoulder: on the way from the present state to point 0, at 0 s, the motion of");
}

}  // namespace
}  // namespace cia402::motion
