// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/setpoint_limiter.h"

#include <gmock/gmock.h>

#include <cmath>

#include "motion/limiter_fixture.h"

namespace cia402::motion {
namespace {

using test::elbow;
using testing::HasSubstr;
constexpr Duration kCycle = std::chrono::milliseconds(4);
constexpr double kDt = 0.004;

/// Runs one limiter in virtual time.
struct Position {
  explicit Position(const Joint& joint, const MotionState& from = {}) : limiter(joint) {
    limiter.reset(from, now);
  }
  MotionState step() { return last = limiter.step(now += kCycle); }
  MotionState follow(double target) {
    EXPECT_TRUE(limiter.command(target));
    return step();
  }
  Time now{};
  MotionState last;
  PositionLimiter limiter;
};

/// A limiter with an ideal axis behind it.
struct Velocity {
  explicit Velocity(const Joint& joint, double from = 0) : limiter(joint) {
    position = from;
    limiter.reset({from, 0, 0}, now);
  }
  MotionState step() {
    last = limiter.step(now += kCycle, position);
    position += last.velocity * kDt;
    return last;
  }
  MotionState follow(double target) {
    EXPECT_TRUE(limiter.command(target));
    return step();
  }
  Time now{};
  double position = 0;
  MotionState last;
  VelocityLimiter limiter;
};

TEST(PositionLimiter, HoldsStillWithoutACommand) {
  Position joint(elbow(), {0.3, 0, 0});
  for (int i = 0; i < 10; ++i) EXPECT_EQ(joint.step().position, 0.3);
}

TEST(PositionLimiter, FirstStepTowardsAFarTargetIsOneAccelerationStep) {
  Position joint(elbow());
  const MotionState state = joint.follow(1);
  EXPECT_NEAR(state.velocity, 0.02, 1e-12);  // 5 rad/s^2 * 4 ms
  EXPECT_NEAR(state.acceleration, 5, 1e-9);
  EXPECT_NEAR(state.position, 8e-5, 1e-15);
}

TEST(PositionLimiter, StepIsReachedInTrapezoidTimeWithoutOvershoot) {
  Position joint(elbow());
  joint.follow(1);
  double highest = 0;
  // 1 rad at 1 rad/s and 5 rad/s^2: 1/1 + 1/5 s = 300 cycles; a few more for braking in steps
  for (int i = 0; i < 310; ++i) highest = std::max(highest, joint.step().position);
  EXPECT_NEAR(joint.last.position, 1, 1e-6);
  EXPECT_LE(highest, 1 + 1e-12);
  for (int i = 0; i < 20; ++i) joint.step();
  EXPECT_NEAR(joint.last.velocity, 0, 1e-12);
  EXPECT_NEAR(joint.last.position, 1, 2e-12);
}

TEST(PositionLimiter, AStreamWithinTheLimitsComesOutUnchanged) {
  Position joint(elbow());
  for (int i = 1; i < 5000; ++i) {
    // 0.9 rad/s and 4.05 rad/s^2 at most, from rest
    const double target = 0.2 * (1 - std::cos(4.5 * i * kDt));
    ASSERT_NEAR(joint.follow(target).position, target, 1e-12) << "cycle " << i;
  }
}

TEST(PositionLimiter, AStreamThatEndsAtSpeedComesToRestAheadOfItsEnd) {
  Position joint(elbow());
  double target = 0, velocity = 0;
  for (int i = 0; i < 100; ++i) {  // 0.8 rad/s after 0.2 s
    velocity = std::min(0.8, velocity + 4.0 * kDt);
    joint.follow(target += velocity * kDt);
  }
  double furthest = target;
  for (int i = 0; i < 200; ++i) {
    const MotionState state = joint.step();
    EXPECT_GE(state.velocity, 0);
    EXPECT_GE(state.acceleration, -5 - 1e-9);
    furthest = std::max(furthest, state.position);
  }
  EXPECT_EQ(joint.last.velocity, 0);
  EXPECT_EQ(joint.last.position, furthest);
  EXPECT_NEAR(furthest, target + 0.8 * 0.8 / (2 * 5.0), 0.8 * kDt);
  EXPECT_EQ(joint.limiter.goal(), furthest);
}

TEST(PositionLimiter, AGapInAStreamIsCaughtUp) {
  Position joint(elbow());
  double target = 0, velocity = 0;
  for (int i = 0; i < 200; ++i) {
    velocity = std::min(0.5, velocity + 4.0 * kDt);
    target += velocity * kDt;
    const bool gap = i == 100 || i == 101;
    const MotionState state = gap ? joint.step() : joint.follow(target);
    EXPECT_GE(state.velocity, 0);
  }
  EXPECT_NEAR(joint.last.position, target, 1e-9);
}

TEST(PositionLimiter, ATargetBehindAMovingJointIsReturnedTo) {
  Position joint(elbow(), {0.0, 0.8, 0});
  joint.follow(-0.2);
  for (int i = 0; i < 500; ++i) joint.step();
  EXPECT_NEAR(joint.last.position, -0.2, 1e-9);
}

TEST(PositionLimiter, TargetsBeyondAPositionLimitEndAtTheLimit) {
  Position joint(elbow());
  joint.follow(100);
  for (int i = 0; i < 2000; ++i) ASSERT_LE(joint.step().position, 2.0);
  EXPECT_NEAR(joint.last.position, 2.0, 1e-9);
  joint.follow(-100);
  for (int i = 0; i < 2000; ++i) ASSERT_GE(joint.step().position, -1.5);
  EXPECT_NEAR(joint.last.position, -1.5, 1e-9);
}

TEST(PositionLimiter, ATargetBeyondAPositionLimitCountsAsTheLimit) {
  Position joint(elbow(), {1.9, 0, 0});
  joint.follow(100);
  EXPECT_EQ(joint.limiter.goal(), 2.0);
  for (int i = 0; i < 500; ++i) joint.step();
  EXPECT_NEAR(joint.last.position, 2.0, 3e-12) << "it stands where the command counts to be";
}

TEST(PositionLimiter, ComesBackFromOutsideItsLimits) {
  Position joint(elbow(), {2.5, 0, 0});
  joint.follow(100);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(joint.step().position, 2.5) << "no way leads there";
  double previous = 2.5;
  for (const double goal : {2.3, 1.0}) {
    joint.follow(goal);
    for (int i = 0; i < 1000; ++i) {
      const double position = joint.step().position;
      ASSERT_LE(position, previous);
      previous = position;
    }
    EXPECT_NEAR(previous, goal, 1e-9) << "as far as it is told";
  }
  joint.follow(100);
  for (int i = 0; i < 2000; ++i) ASSERT_LE(joint.step().position, 2.0);
  EXPECT_NEAR(joint.last.position, 2.0, 1e-9);
}

TEST(PositionLimiter, ATargetThatIsTakenBackButStillAheadDoesNotTurnTheJointBack) {
  Position joint(elbow());
  EXPECT_NEAR(joint.follow(2.0).velocity, 0.02, 1e-12);  // 5 rad/s^2 * 4 ms
  EXPECT_NEAR(joint.follow(0.5).velocity, 0.04, 1e-12) << "nobody moves by -1.5 rad in a cycle";
}

TEST(PositionLimiter, AfterAResetNothingOfBeforeIsLeft) {
  Position joint(elbow());
  joint.follow(1);
  joint.limiter.reset({0.3, 0, 0}, joint.now);
  EXPECT_FALSE(joint.limiter.goal());
  EXPECT_EQ(joint.step().position, 0.3) << "not on its way to the command of before";
}

TEST(PositionLimiter, AnUnknownVelocityCountsAsRest) {
  Position joint(elbow(), {0.3, std::nan(""), 0});
  EXPECT_NEAR(joint.follow(1).velocity, 0.02, 1e-12) << "not at full speed at once";
  Position resting(elbow(), {0.3, std::nan(""), 0});
  EXPECT_EQ(resting.step().velocity, 0);
}

TEST(PositionLimiter, NotANumberIsRefused) {
  Position joint(elbow());
  joint.follow(1);
  const auto result = joint.limiter.command(std::nan(""));
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("elbow: the commanded value is nan rad"));
  EXPECT_EQ(joint.limiter.goal(), 1.0) << "the previous one counts";
}

TEST(PositionLimiter, TimeThatStandsStillOrRunsBackChangesNothing) {
  Position joint(elbow());
  const MotionState state = joint.follow(1);
  EXPECT_EQ(joint.limiter.step(joint.now).position, state.position);
  EXPECT_EQ(joint.limiter.step(joint.now - kCycle).velocity, state.velocity);
}

TEST(PositionLimiter, WithoutAnyLimitsTheTargetIsReachedAtOnce) {
  Position joint(Joint{});
  EXPECT_EQ(joint.follow(7).position, 7);
  EXPECT_EQ(joint.follow(7).velocity, 0);
}

TEST(VelocityLimiter, AcceleratesToTheCommandAtTheLimit) {
  Velocity joint(elbow());
  EXPECT_NEAR(joint.follow(0.5).velocity, 0.02, 1e-12);
  for (int i = 1; i < 25; ++i) joint.step();
  EXPECT_NEAR(joint.last.velocity, 0.5, 1e-12);
  joint.step();
  EXPECT_EQ(joint.last.velocity, 0.5);
  EXPECT_NEAR(joint.follow(-9).velocity, 0.48, 1e-12);
}

TEST(VelocityLimiter, TimeThatStandsStillOrRunsBackChangesNothing) {
  Velocity joint(elbow());
  joint.follow(0.5);
  for (const Time now : {joint.now, joint.now - kCycle}) {
    const MotionState state = joint.limiter.step(now, 1.0);
    EXPECT_EQ(state.position, 0);
    EXPECT_NEAR(state.velocity, 0.02, 1e-12);
    EXPECT_NEAR(state.acceleration, 5, 1e-9);
  }
}

TEST(VelocityLimiter, NeverFasterThanTheLimit) {
  Velocity joint(elbow());
  joint.follow(50);
  for (int i = 0; i < 100; ++i) joint.step();
  EXPECT_NEAR(joint.last.velocity, 1, 1e-12);
}

TEST(VelocityLimiter, BrakesBeforeAPositionLimitAndMayLeaveItAgain) {
  Velocity joint(elbow(), 1.5);
  joint.follow(1);
  for (int i = 0; i < 1000; ++i) {
    joint.step();
    ASSERT_LE(joint.position, 2.0 + 1e-12);
  }
  EXPECT_NEAR(joint.position, 2.0, 1e-6);
  EXPECT_NEAR(joint.follow(-1).velocity, -0.02, 1e-9);
}

TEST(VelocityLimiter, LateFeedbackDoesNotCarryItOverTheLimit) {
  for (const std::size_t delay : {1U, 2U, 5U}) {
    VelocityLimiter limiter(elbow(), kCycle * static_cast<int>(delay));
    Time now{};
    limiter.reset({}, now);
    ASSERT_TRUE(limiter.command(1));
    std::vector<double> pending(delay, 0.0);  // velocities on their way to the axis
    double position = 0;
    for (std::size_t i = 0; i < 3000; ++i) {
      const double velocity = limiter.step(now += kCycle, position).velocity;
      position += pending[i % delay] * kDt;
      pending[i % delay] = velocity;
      ASSERT_LE(position, 2.0 + 1e-9) << delay << " cycles late, in cycle " << i;
    }
    EXPECT_NEAR(position, 2.0, 1e-3);
  }
}

TEST(VelocityLimiter, OutsideItsLimitsAJointOnlyMovesBack) {
  Velocity joint(elbow(), 2.1);
  EXPECT_EQ(joint.follow(1).velocity, 0);
  EXPECT_NEAR(joint.follow(-1).velocity, -0.02, 1e-12);
}

TEST(VelocityLimiter, UnknownPositionStopsAJointThatHasPositionLimits) {
  Velocity joint(elbow());
  for (int i = 0; i < 50; ++i) joint.follow(0.5);
  const double nan = std::nan("");
  EXPECT_NEAR(joint.limiter.step(joint.now += kCycle, nan).velocity, 0.48, 1e-12);
  for (int i = 0; i < 30; ++i) joint.last = joint.limiter.step(joint.now += kCycle, nan);
  EXPECT_EQ(joint.last.velocity, 0);

  Joint wheel = elbow();
  wheel.limits.lower.reset();
  Velocity one_limit(wheel);
  ASSERT_TRUE(one_limit.limiter.command(-0.5));
  EXPECT_EQ(one_limit.limiter.step(one_limit.now += kCycle, nan).velocity, 0);

  wheel.limits.upper.reset();
  Velocity turning(wheel);
  ASSERT_TRUE(turning.limiter.command(0.5));
  EXPECT_NEAR(turning.limiter.step(turning.now += kCycle, nan).velocity, 0.02, 1e-12);
}

TEST(VelocityLimiter, NotANumberIsRefused) {
  Velocity joint(elbow());
  const auto result = joint.limiter.command(INFINITY);
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("elbow: the commanded value is inf rad/s"));
}

}  // namespace
}  // namespace cia402::motion
