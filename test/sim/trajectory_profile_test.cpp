// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/trajectory_profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/drive/motor.h"
#include "sim/drive/trajectory_interpolator.h"

namespace cia402::sim {
namespace {

int stepsToReach(TrapezoidProfile& profile, double target, const ProfileLimits& limits) {
  for (int i = 1; i < 100000; ++i) {
    profile.step(target, limits);
    if (profile.position() == target && profile.velocity() == 0.0) return i;
  }
  return -1;
}

TEST(TrapezoidProfile, TakesTheTimeOfATrapezoid) {
  TrapezoidProfile profile;
  // Up 0.2 s (0.2 turns), down 0.4 s (0.4 turns), 1.4 turns at 2 turns/s: 1.3 s.
  EXPECT_NEAR(stepsToReach(profile, 2.0, {2.0, 10.0, 5.0}) * kDriveStepS, 1.3, 0.003);
}

TEST(TrapezoidProfile, TakesTheTimeOfATriangleWhenTheWayIsShort) {
  TrapezoidProfile profile;
  EXPECT_NEAR(stepsToReach(profile, -0.1, {2.0, 10.0, 10.0}) * kDriveStepS, 0.2, 0.003);
}

TEST(TrapezoidProfile, NeverExceedsItsLimitsNorTheTarget) {
  TrapezoidProfile profile;
  double before = 0.0;
  for (int i = 0; i < 4000; ++i) {
    profile.step(2.0, {2.0, 10.0, 5.0});
    const double acceleration = (profile.velocity() - before) / kDriveStepS;
    EXPECT_LE(profile.velocity(), 2.0 + 1e-12);
    EXPECT_LE(acceleration, 10.0 + 1e-6);
    if (profile.position() != 2.0) {
      EXPECT_GE(acceleration, -5.1);
    }
    EXPECT_LE(profile.position(), 2.0);
    before = profile.velocity();
  }
}

TEST(TrapezoidProfile, ComesBackWhenTheTargetIsSetTooCloseAhead) {
  TrapezoidProfile profile;
  for (int i = 0; i < 1000; ++i) profile.step(100.0, {2.0, 10.0, 10.0});
  const double target = profile.position() + 0.05;  // needs 0.2
  double highest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    profile.step(target, {2.0, 10.0, 10.0});
    highest = std::max(highest, profile.position());
  }
  EXPECT_NEAR(highest - target, 0.15, 0.005);
  EXPECT_EQ(profile.position(), target);
}

TEST(TrapezoidProfile, StandsStillWithoutSpeedOrRamp) {
  TrapezoidProfile profile;
  for (int i = 0; i < 100; ++i) profile.step(1.0, {0.0, 10.0, 10.0});
  EXPECT_EQ(profile.position(), 0.0);
  for (int i = 0; i < 100; ++i) profile.step(1.0, {1.0, 0.0, 0.0});
  EXPECT_EQ(profile.position(), 0.0);
}

TEST(RampVelocity, UsesTheDecelerationWhileTheSpeedShrinks) {
  EXPECT_DOUBLE_EQ(rampVelocity(0.0, 1.0, 10.0, 20.0), 0.005);
  EXPECT_DOUBLE_EQ(rampVelocity(1.0, 0.0, 10.0, 20.0), 0.99);
  EXPECT_DOUBLE_EQ(rampVelocity(1.0, -1.0, 10.0, 20.0), 0.99);
  EXPECT_DOUBLE_EQ(rampVelocity(0.005, -1.0, 10.0, 20.0), 0.0);
  EXPECT_DOUBLE_EQ(rampVelocity(-1.0, -1.001, 10.0, 20.0), -1.001);
}

TEST(LinearInterpolator, DrawsALineAndWaitsAtItsEnd) {
  LinearInterpolator line;
  line.moveTo(1.0, 0.004);  // 8 steps
  line.step();
  EXPECT_DOUBLE_EQ(line.position(), 0.125);
  EXPECT_DOUBLE_EQ(line.velocity(), 250.0);
  for (int i = 0; i < 7; ++i) line.step();
  EXPECT_EQ(line.position(), 1.0);
  line.step();
  EXPECT_EQ(line.position(), 1.0);
  EXPECT_EQ(line.velocity(), 0.0);
}

// Lines of 2 ms and 2 turns; the steps are 0.5 ms apart.
TEST(LinearInterpolator, BeginsBetweenSteps) {
  LinearInterpolator line;
  line.moveTo(2.0, 0.002, 0.0002);
  line.step();
  EXPECT_NEAR(line.position(), 0.3, 1e-12);
  for (int i = 0; i < 3; ++i) line.step();
  EXPECT_NEAR(line.position(), 1.8, 1e-12);
  line.step();  // it ends 0.2 ms into this one
  EXPECT_EQ(line.position(), 2.0);
  EXPECT_NEAR(line.velocity(), 1000.0, 1e-9);
  line.step();
  EXPECT_EQ(line.position(), 2.0);
  EXPECT_EQ(line.velocity(), 0.0);
}

TEST(LinearInterpolator, GoesOnEvenlyWhereSyncComesALittleLateOrEarly) {
  LinearInterpolator line;
  line.moveTo(2.0, 0.002, 0.0);  // at the step, then 1 us late, at the step, 1 us early
  for (int i = 0; i < 4; ++i) line.step();
  line.moveTo(4.0, 0.002, 0.000001);
  line.step();
  EXPECT_NEAR(line.position(), 2.499, 1e-9);
  for (int i = 0; i < 3; ++i) line.step();
  line.moveTo(6.0, 0.002, 0.0);
  EXPECT_NEAR(line.position(), 3.999, 1e-9);
  for (int i = 0; i < 3; ++i) line.step();
  line.moveTo(8.0, 0.002, 0.000499);
  line.step();
  EXPECT_NEAR(line.position(), 6.0, 0.002);
  line.step();
  EXPECT_NEAR(line.position(), 6.5, 0.002);
}

}  // namespace
}  // namespace cia402::sim
