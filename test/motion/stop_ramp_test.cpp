// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/motion/stop_ramp.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace cia402::motion {
namespace {

using testing::HasSubstr;
constexpr Time kStart{std::chrono::seconds(10)};

StopLimits decelerating(double deceleration, std::optional<double> jerk = std::nullopt) {
  StopLimits limits;
  limits.deceleration = deceleration;
  limits.jerk = jerk;
  return limits;
}

TEST(StopRamp, ConstantDecelerationFromTwoRadiansPerSecond) {
  const StopRamp ramp({1, 2, 0}, decelerating(4), kStart);
  EXPECT_NEAR(ramp.duration(), 0.5, 1e-15);
  EXPECT_EQ(ramp.endTime(), kStart + fromSeconds(0.5));
  EXPECT_NEAR(ramp.stopPosition(), 1.5, 1e-15);
  const MotionState middle = ramp.sample(kStart + fromSeconds(0.25));
  EXPECT_NEAR(middle.position, 1.375, 1e-12);
  EXPECT_NEAR(middle.velocity, 1, 1e-12);
  EXPECT_NEAR(middle.acceleration, -4, 1e-12);
}

TEST(StopRamp, WorksInBothDirections) {
  const StopRamp ramp({1, -2, 0}, decelerating(4), kStart);
  EXPECT_NEAR(ramp.stopPosition(), 0.5, 1e-15);
  EXPECT_NEAR(ramp.sample(kStart).acceleration, 4, 1e-15);
}

TEST(StopRamp, AfterwardsTheJointRests) {
  const StopRamp ramp({1, 2, 0}, decelerating(4), kStart);
  EXPECT_FALSE(ramp.finished(kStart + fromSeconds(0.49)));
  EXPECT_TRUE(ramp.finished(kStart + fromSeconds(0.5)));
  const MotionState after = ramp.sample(kStart + fromSeconds(3));
  EXPECT_EQ(after.position, ramp.stopPosition());
  EXPECT_EQ(after.velocity, 0);
  EXPECT_EQ(after.acceleration, 0);
}

TEST(StopRamp, AJointAtRestStaysWhereItIs) {
  const StopRamp ramp({0.7, 0, 0}, decelerating(4, 10), kStart);
  EXPECT_TRUE(ramp.finished(kStart));
  EXPECT_EQ(ramp.sample(kStart).position, 0.7);
}

TEST(StopRamp, JerkLimitedRampWithThreePhases) {
  // 2 rad/s, 4 rad/s², 16 rad/s³: 0.25 s to full deceleration, 0.25 s of it, 0.25 s back; by
  // symmetry the mean velocity is 1 rad/s.
  const StopRamp ramp({0, 2, 0}, decelerating(4, 16), kStart);
  EXPECT_NEAR(ramp.duration(), 0.75, 1e-12);
  EXPECT_NEAR(ramp.stopPosition(), 0.75, 1e-12);
  const MotionState first = ramp.sample(kStart + fromSeconds(0.25));
  EXPECT_NEAR(first.velocity, 1.5, 1e-9);
  EXPECT_NEAR(first.acceleration, -4, 1e-9);
  const MotionState second = ramp.sample(kStart + fromSeconds(0.5));
  EXPECT_NEAR(second.velocity, 0.5, 1e-9);
  EXPECT_NEAR(second.acceleration, -4, 1e-9);
}

TEST(StopRamp, SlowJointNeedsNotReachFullDeceleration) {
  // peak = sqrt(j v) = sqrt(16 * 0.25) = 2 rad/s², two phases of 0.125 s
  const StopRamp ramp({0, 0.25, 0}, decelerating(4, 16), kStart);
  EXPECT_NEAR(ramp.duration(), 0.25, 1e-12);
  EXPECT_NEAR(ramp.sample(kStart + fromSeconds(0.125)).acceleration, -2, 1e-9);
}

TEST(StopRamp, RandomJerkLimitedRampsAreSmoothWithinLimitsAndEndAtRest) {
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> random(-1, 1);
  for (int i = 0; i < 3000; ++i) {
    const MotionState state{random(engine), 3 * random(engine), 12 * random(engine)};
    const double deceleration = 4 + 3 * random(engine), jerk = 50 + 45 * random(engine);
    const StopRamp ramp(state, decelerating(deceleration, jerk), kStart);
    const double steepest = std::max(deceleration, std::abs(state.acceleration)) + 1e-6;
    MotionState previous = ramp.sample(kStart);
    EXPECT_NEAR(previous.velocity, state.velocity, 1e-12);
    EXPECT_NEAR(previous.acceleration, state.acceleration, 1e-12);
    const int steps = 200;
    const double dt = ramp.duration() / steps;
    for (int k = 1; k <= steps; ++k) {
      const MotionState now = ramp.sample(kStart + fromSeconds(dt * k));
      ASSERT_LE(std::abs(now.acceleration), steepest);
      ASSERT_LE(std::abs(now.acceleration - previous.acceleration), jerk * (dt + 3e-9) + 1e-6);
      ASSERT_NEAR(now.velocity - previous.velocity,
                  (now.acceleration + previous.acceleration) / 2 * dt, jerk * dt * dt + 1e-6);
      ASSERT_NEAR(now.position - previous.position, (now.velocity + previous.velocity) / 2 * dt,
                  steepest * dt * dt + 1e-6);
      previous = now;
    }
    ASSERT_NEAR(ramp.sample(ramp.endTime() - Duration(1)).velocity, 0, 1e-6);
    ASSERT_NEAR(ramp.sample(ramp.endTime() - Duration(1)).acceleration, 0, 1e-5);
  }
}

TEST(StopRamp, BecomesSteeperRatherThanEndBeyondAPositionLimit) {
  StopLimits limits = decelerating(1);
  limits.upper = 0.5;
  limits.hardest = 10;
  // 2 rad/s, 0.25 rad before the limit: v²/(2 s) = 8 rad/s²
  const StopRamp ramp({0.25, 2, 0}, limits, kStart);
  EXPECT_NEAR(ramp.stopPosition(), 0.5, 1e-12);
  EXPECT_NEAR(ramp.sample(kStart).acceleration, -8, 1e-12);
  limits.jerk = 5;
  EXPECT_NEAR(StopRamp({0.25, 2, 0}, limits, kStart).stopPosition(), 0.5, 1e-12);
  limits.lower = -0.5;
  EXPECT_NEAR(StopRamp({-0.25, -2, 0}, limits, kStart).stopPosition(), -0.5, 1e-12);
}

TEST(StopRamp, NeverExceedsTheHardestDeceleration) {
  StopLimits limits = decelerating(1);
  limits.upper = 0.5;
  limits.hardest = 4;
  const StopRamp ramp({0.25, 2, 0}, limits, kStart);
  EXPECT_NEAR(ramp.sample(kStart).acceleration, -4, 1e-12);
  EXPECT_NEAR(ramp.stopPosition(), 0.75, 1e-12);
}

TEST(StopRamp, OutsideItsLimitsAJointIsJustStopped) {
  StopLimits limits = decelerating(1);
  limits.upper = 0.5;
  limits.hardest = 10;
  EXPECT_NEAR(StopRamp({0.6, 1, 0}, limits, kStart).sample(kStart).acceleration, -1, 1e-12);
}

TEST(StopRamp, WhatCannotBeComputedIsHeldAtOnce) {
  const double nan = std::nan("");
  EXPECT_EQ(StopRamp({0.7, 2, 0}, decelerating(0), kStart).sample(kStart).velocity, 0);
  EXPECT_EQ(StopRamp({0.7, 2, 0}, decelerating(nan), kStart).sample(kStart).position, 0.7);
  EXPECT_EQ(StopRamp({0.7, nan, 0}, decelerating(1), kStart).sample(kStart).position, 0.7);
  EXPECT_TRUE(StopRamp({0.7, nan, 0}, decelerating(1), kStart).finished(kStart));
}

TEST(StopRamp, BeforeItsStartTheStartCounts) {
  EXPECT_EQ(StopRamp({0.7, 2, 0}, decelerating(1), kStart).sample(Time{}).position, 0.7);
  EXPECT_EQ(StopRamp({0.7, 2, 0}, decelerating(0), kStart).sample(Time{}).position, 0.7);
}

TEST(StopRamp, LimitsComeFromTheJoint) {
  Joint joint{"elbow", {}, JointUnit::radian};
  joint.limits.upper = 2;
  joint.limits.acceleration = 8;
  const auto limits = stopLimits(joint, 4, 40);
  ASSERT_TRUE(limits);
  EXPECT_EQ(limits->upper, 2);
  EXPECT_EQ(limits->hardest, 8);
  EXPECT_EQ(limits->jerk, 40);
}

TEST(StopRamp, UselessLimitsAreRefusedInWords) {
  const Joint joint{"elbow", {}, JointUnit::metre};
  const auto deceleration = stopLimits(joint, -2);
  ASSERT_FALSE(deceleration);
  EXPECT_THAT(deceleration.error().message,
              HasSubstr("elbow: the stop ramp's deceleration is -2 m/s²; it must be"));
  const auto jerk = stopLimits(joint, 2, 0.0);
  ASSERT_FALSE(jerk);
  EXPECT_THAT(jerk.error().message, HasSubstr("elbow: the stop ramp's jerk is 0 m/s³"));
}

TEST(GroupStop, EachJointStopsByItsOwnRampAndTheLastOneEndsIt) {
  GroupStop stop({decelerating(4), decelerating(1)});
  stop.start({{0, 2, 0}, {0, 2, 0}}, kStart);
  EXPECT_EQ(stop.endTime(), kStart + fromSeconds(2));
  std::vector<MotionState> states(2);
  stop.sample(kStart + fromSeconds(1), states);
  EXPECT_EQ(states[0].velocity, 0);
  EXPECT_NEAR(states[0].position, 0.5, 1e-12);
  EXPECT_NEAR(states[1].velocity, 1, 1e-12);
  EXPECT_FALSE(stop.finished(kStart + fromSeconds(1)));
  EXPECT_TRUE(stop.finished(kStart + fromSeconds(2)));
}

}  // namespace
}  // namespace cia402::motion
