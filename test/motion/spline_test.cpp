// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cia402::motion {
namespace {

void expectState(const MotionState& state, double position, double velocity, double acceleration) {
  EXPECT_NEAR(state.position, position, 1e-12);
  EXPECT_NEAR(state.velocity, velocity, 1e-12);
  EXPECT_NEAR(state.acceleration, acceleration, 1e-12);
}

TEST(Spline, LinearHasConstantVelocity) {
  const auto segment = SplineSegment::linear(1, 3, 4);
  expectState(segment.sample(0), 1, 0.5, 0);
  expectState(segment.sample(1), 1.5, 0.5, 0);
  expectState(segment.sample(4), 3, 0.5, 0);
}

TEST(Spline, CubicFromRestToRestInOneSecond) {
  const auto segment = SplineSegment::cubic({0, 0, 0}, {1, 0, 0}, 1);
  expectState(segment.sample(0), 0, 0, 6);
  expectState(segment.sample(0.25), 0.15625, 1.125, 3);
  expectState(segment.sample(0.5), 0.5, 1.5, 0);
  expectState(segment.sample(1), 1, 0, -6);
}

TEST(Spline, QuinticFromRestToRestInOneSecond) {
  const auto segment = SplineSegment::quintic({0, 0, 0}, {1, 0, 0}, 1);
  expectState(segment.sample(0), 0, 0, 0);
  expectState(segment.sample(0.5), 0.5, 1.875, 0);
  expectState(segment.sample(0.25), 0.103515625, 1.0546875, 5.625);
  expectState(segment.sample(1), 1, 0, 0);
}

TEST(Spline, DurationScalesVelocityAndAcceleration) {
  const auto segment = SplineSegment::quintic({0, 0, 0}, {1, 0, 0}, 2);
  expectState(segment.sample(1), 0.5, 0.9375, 0);
  expectState(segment.sample(0.5), 0.103515625, 0.52734375, 1.40625);
}

TEST(Spline, OutsideTheSegmentTheNearerEndCounts) {
  const auto segment = SplineSegment::cubic({1, 2, 0}, {5, 3, 0}, 2);
  EXPECT_EQ(segment.sample(-1).position, 1);
  EXPECT_NEAR(segment.sample(9).position, 5, 1e-12);
  EXPECT_NEAR(segment.sample(9).velocity, 3, 1e-12);
}

TEST(Spline, ExtremaOfTheRestToRestQuinticAreThoseOfTheTextbook) {
  // velocity 15/8 at T/2; acceleration ±10/sqrt(3) at T (1/2 ∓ sqrt(3)/6)
  const auto segment = SplineSegment::quintic({0, 0, 0}, {1, 0, 0}, 1);
  EXPECT_NEAR(segment.velocityRange().max.value, 1.875, 1e-12);
  EXPECT_NEAR(segment.velocityRange().max.time_s, 0.5, 1e-9);
  EXPECT_NEAR(segment.accelerationRange().max.value, 5.773502691896258, 1e-12);
  EXPECT_NEAR(segment.accelerationRange().max.time_s, 0.21132486540518713, 1e-9);
  EXPECT_NEAR(segment.accelerationRange().min.value, -5.773502691896258, 1e-12);
}

TEST(Spline, CubicOvershootBetweenItsPointsIsFound) {
  // leaves 0 at 1 rad/s and comes back to rest at 0: t - 2t² + t³ peaks at t = 1/3 with 4/27
  const auto segment = SplineSegment::cubic({0, 1, 0}, {0, 0, 0}, 1);
  EXPECT_NEAR(segment.positionRange().max.value, 4.0 / 27, 1e-12);
  EXPECT_NEAR(segment.positionRange().max.time_s, 1.0 / 3, 1e-9);
  EXPECT_NEAR(segment.velocityRange().min.value, -1.0 / 3, 1e-12);
}

TEST(Spline, TheLargestOfARangeIsTheOneFartherFromZero) {
  const Range range{{-3, 0.1}, {2, 0.2}};
  EXPECT_EQ(range.largest().value, -3);
  EXPECT_EQ((Range{{-1, 0.1}, {2, 0.2}}.largest().value), 2);
}

TEST(Spline, OverflowIsReported) {
  EXPECT_TRUE(SplineSegment::quintic({0, 1, 1}, {1, 1, 1}, 1e-9).isFinite());
  EXPECT_FALSE(SplineSegment::cubic({0, 0, 0}, {1e300, 0, 0}, 1e-9).isFinite());
  EXPECT_FALSE(SplineSegment::linear(-1.7e308, 1.7e308, 1).isFinite());
}

class RandomSplines : public testing::Test {
 protected:
  double random(double magnitude) {
    return std::uniform_real_distribution<double>(-magnitude, magnitude)(engine_);
  }
  MotionState randomState() { return {random(3), random(5), random(20)}; }
  double randomDuration() { return std::pow(10.0, random(2.5)); }
  std::mt19937 engine_{20260101};
};

TEST_F(RandomSplines, QuinticsMeetBothEnds) {
  for (int i = 0; i < 2000; ++i) {
    const MotionState a = randomState(), b = randomState();
    const double duration = randomDuration();
    const auto segment = SplineSegment::quintic(a, b, duration);
    for (const auto& [got, wanted] :
         {std::pair(segment.sample(0), a), std::pair(segment.sample(duration), b)}) {
      const double scale = 1 + std::abs(a.velocity * duration) + 20 * duration * duration;
      EXPECT_NEAR(got.position, wanted.position, 1e-13 * scale);
      EXPECT_NEAR(got.velocity, wanted.velocity, 1e-12 * scale / duration);
      EXPECT_NEAR(got.acceleration, wanted.acceleration, 1e-11 * scale / (duration * duration));
    }
  }
}

TEST_F(RandomSplines, VelocityIsTheSlopeOfPositionAndAccelerationThatOfVelocity) {
  for (int i = 0; i < 500; ++i) {
    const auto segment = SplineSegment::quintic(randomState(), randomState(), 1);
    const double t = 0.5 + random(0.49), h = 1e-5;
    const MotionState before = segment.sample(t - h), at = segment.sample(t),
                      after = segment.sample(t + h);
    EXPECT_NEAR(at.velocity, (after.position - before.position) / (2 * h), 1e-5);
    EXPECT_NEAR(at.acceleration, (after.velocity - before.velocity) / (2 * h), 1e-4);
  }
}

TEST_F(RandomSplines, NoSampleLeavesTheRangesAndTheRangesAreReached) {
  for (int i = 0; i < 1000; ++i) {
    const double duration = randomDuration();
    const MotionState a = randomState(), b = randomState();
    const auto segment =
        i % 2 == 0 ? SplineSegment::quintic(a, b, duration) : SplineSegment::cubic(a, b, duration);
    const Range position = segment.positionRange(), velocity = segment.velocityRange(),
                acceleration = segment.accelerationRange();
    const auto margin = [](const Range& range) {
      return 1e-9 * (1e-3 + std::abs(range.largest().value));
    };
    for (int k = 0; k <= 200; ++k) {
      const MotionState state = segment.sample(duration * k / 200);
      EXPECT_LE(state.position, position.max.value + margin(position));
      EXPECT_GE(state.position, position.min.value - margin(position));
      EXPECT_LE(state.velocity, velocity.max.value + margin(velocity));
      EXPECT_GE(state.velocity, velocity.min.value - margin(velocity));
      EXPECT_LE(state.acceleration, acceleration.max.value + margin(acceleration));
      EXPECT_GE(state.acceleration, acceleration.min.value - margin(acceleration));
    }
    EXPECT_NEAR(segment.sample(position.max.time_s).position, position.max.value, margin(position));
    EXPECT_NEAR(segment.sample(velocity.min.time_s).velocity, velocity.min.value, margin(velocity));
    EXPECT_NEAR(segment.sample(acceleration.max.time_s).acceleration, acceleration.max.value,
                margin(acceleration));
  }
}

TEST(Spline, IsSurelyWithinLimitsOnlyIfEachOfThemIsKept) {
  // 0 to 1 rad in 1 s at rest on both ends: up to 1.5 rad/s and 6 rad/s^2
  const auto segment = SplineSegment::cubic({0, 0, 0}, {1, 0, 0}, 1);
  JointLimits limits;
  EXPECT_TRUE(segment.surelyWithin(limits));
  limits.lower = -0.1;
  limits.upper = 1.1;
  limits.velocity = 4.0;
  limits.acceleration = 7.0;
  EXPECT_TRUE(segment.surelyWithin(limits));
  const auto violated = [&](auto change) {
    JointLimits tight = limits;
    change(tight);
    return !segment.surelyWithin(tight);
  };
  EXPECT_TRUE(violated([](JointLimits& l) { l.lower = 0.01; }));
  EXPECT_TRUE(violated([](JointLimits& l) { l.upper = 0.99; }));
  EXPECT_TRUE(violated([](JointLimits& l) { l.velocity = 1.49; }));
  EXPECT_TRUE(violated([](JointLimits& l) { l.acceleration = 5.9; }));
}

}  // namespace
}  // namespace cia402::motion
