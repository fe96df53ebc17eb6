// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "motion/limiter_fixture.h"
#include "motion/setpoint_limiter.h"

namespace cia402::motion {
namespace {

using test::Storm;

constexpr double kLower = -1.5, kUpper = 2.0, kVelocity = 1.5, kAcceleration = 6.0;
constexpr int kCycles = 100000;

Joint limited() {
  Joint joint;
  joint.name = "elbow";
  joint.limits.lower = kLower;
  joint.limits.upper = kUpper;
  joint.limits.velocity = kVelocity;
  joint.limits.acceleration = kAcceleration;
  return joint;
}

class EverySeed : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, EverySeed, testing::Values(1U, 2U, 3U, 4U, 5U));

TEST_P(EverySeed, PositionOutputNeverViolatesALimit) {
  Storm storm(GetParam());
  PositionLimiter limiter(limited());
  Time now{};
  limiter.reset({}, now);
  double position = 0, velocity = 0, top_speed = 0, top = 0, bottom = 0;
  for (int i = 0; i < kCycles; ++i) {
    if (const auto command = storm.command(4)) static_cast<void>(limiter.command(*command));
    const Duration cycle = storm.cycle();
    const double dt = toSeconds(cycle);
    const MotionState state = limiter.step(now += cycle);
    const double next = state.position;
    // Differences of the positions alone: what the drive sees.
    const double next_velocity = (next - position) / dt;
    ASSERT_LE(next, kUpper) << i;
    ASSERT_GE(next, kLower) << i;
    ASSERT_LE(std::abs(next_velocity), kVelocity + 1e-9) << i;
    ASSERT_LE(std::abs(next_velocity - velocity) / dt, kAcceleration + 1e-6) << i;
    ASSERT_NEAR(state.velocity, next_velocity, 1e-9) << i;
    position = next;
    velocity = next_velocity;
    top_speed = std::max(top_speed, std::abs(velocity));
    top = std::max(top, position);
    bottom = std::min(bottom, position);
  }
  // The storm did drive the joint to its limits.
  EXPECT_GT(top_speed, 0.99 * kVelocity);
  EXPECT_GT(top, kUpper - 1e-3);
  EXPECT_LT(bottom, kLower + 1e-3);
}

TEST_P(EverySeed, VelocityOutputNeverViolatesALimit) {
  Storm storm(GetParam());
  VelocityLimiter limiter(limited());
  Time now{};
  limiter.reset({}, now);
  double position = 0, velocity = 0, top_speed = 0, top = 0, bottom = 0;
  for (int i = 0; i < kCycles; ++i) {
    if (const auto command = storm.command(3)) static_cast<void>(limiter.command(*command));
    const Duration cycle = storm.cycle();
    const double dt = toSeconds(cycle);
    const double next = limiter.step(now += cycle, position).velocity;
    ASSERT_LE(std::abs(next), kVelocity + 1e-12) << i;
    ASSERT_LE(std::abs(next - velocity) / dt, kAcceleration + 1e-9) << i;
    velocity = next;
    position += velocity * dt;
    ASSERT_LE(position, kUpper + 1e-9) << i;
    ASSERT_GE(position, kLower - 1e-9) << i;
    top_speed = std::max(top_speed, std::abs(velocity));
    top = std::max(top, position);
    bottom = std::min(bottom, position);
  }
  EXPECT_GT(top_speed, 0.99 * kVelocity);
  EXPECT_GT(top, kUpper - 1e-3);
  EXPECT_LT(bottom, kLower + 1e-3);
}

TEST_P(EverySeed, RoundingCarriesNoPositionOverAnyLimit) {
  Storm storm(GetParam());
  for (int run = 0; run < 2000; ++run) {
    Joint odd = limited();
    odd.limits.lower = -1 + storm.random(0.5);
    odd.limits.upper = 1 + storm.random(0.5);
    odd.limits.velocity.reset();
    if (run % 2 == 0) odd.limits.acceleration.reset();
    PositionLimiter limiter(odd);
    Time now{};
    limiter.reset({storm.random(0.4), 0, 0}, now);
    for (int i = 0; i < 40; ++i) {
      ASSERT_TRUE(limiter.command(i % 20 < 10 ? 9 : -9));
      const double position = limiter.step(now += fromSeconds(0.1 + storm.random(0.09))).position;
      ASSERT_LE(position, *odd.limits.upper);
      ASSERT_GE(position, *odd.limits.lower);
    }
  }
}

TEST_P(EverySeed, AConstantTargetIsReachedWithoutOvershootFromAnyStart) {
  Storm storm(GetParam());
  for (int run = 0; run < 200; ++run) {
    PositionLimiter limiter(limited());
    Time now{};
    const double from = storm.random(1.4), target = storm.random(1.4);
    limiter.reset({from, 0, 0}, now);
    const double sign = target >= from ? 1 : -1;
    double position = from;
    for (int i = 0; i < 1500; ++i) {
      ASSERT_TRUE(limiter.command(target));
      position = limiter.step(now += std::chrono::milliseconds(4)).position;
      ASSERT_LE(sign * (position - target), 1e-12);
    }
    ASSERT_NEAR(position, target, 1e-9);
  }
}

}  // namespace
}  // namespace cia402::motion
