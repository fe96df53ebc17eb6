// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/motor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace cia402::sim {
namespace {

MotorParameters parameters() {
  MotorParameters p;
  p.position_time_constant = 0.004;
  p.rated_acceleration = 100.0;
  p.max_torque = 2.0;
  p.max_speed = 50.0;
  p.friction = 0.1;
  p.viscous_friction = 0.0;
  return p;
}

void steps(int count, const std::function<void()>& step) {
  for (int i = 0; i < count; ++i) step();
}

TEST(Motor, LagsBehindASteadyDemandByVelocityTimesTimeConstant) {
  Motor motor(parameters(), 0.0);
  double demand = 0.0;
  steps(1000, [&] { motor.followPosition(demand += 10.0 * kDriveStepS); });
  EXPECT_NEAR(demand - motor.position(), 0.04, 1e-6);
  EXPECT_NEAR(motor.velocity(), 10.0, 1e-6);
  EXPECT_NEAR(motor.torque(), 0.1, 1e-6);  // friction only
}

TEST(Motor, DoesNotLagWhereItsVelocityLoopIsToldTheSpeed) {
  Motor motor(parameters(), 0.0);
  double demand = 0.0;
  steps(1000, [&] { motor.followPosition(demand += 10.0 * kDriveStepS, {10.0, 0.0}); });
  EXPECT_NEAR(demand - motor.position(), 0.0, 1e-6);
  EXPECT_NEAR(motor.velocity(), 10.0, 1e-6);
}

// A proportional loop: the error that balances the offset.
TEST(Motor, IsHeldAwayFromItsDemandByAnOffsetThatStays) {
  Motor motor(parameters(), 0.0);
  steps(2000, [&] { motor.followPosition(0.0, {2.0, 0.0}); });
  EXPECT_NEAR(motor.position(), 2.0 * 0.004, 1e-6);
}

// Faster than its torque could stop it within the lag.
TEST(Motor, KeepsItsSpeedWhereAPositionTakesOverFromATorque) {
  Motor motor(parameters(), 0.0);
  steps(1000, [&] { motor.applyTorque(2.0, 40.0); });
  EXPECT_NEAR(motor.velocity(), 40.0, 1e-6);
  double demand = motor.position() + 40.0 * 0.004;
  steps(20, [&] {
    motor.followPosition(demand += 40.0 * kDriveStepS);
    EXPECT_NEAR(motor.velocity(), 40.0, 1e-3);
  });
}

TEST(Motor, ReachesAStepWithoutOvershootAndStandsExactly) {
  Motor motor(parameters(), 0.0);
  double highest = 0.0;
  steps(2000, [&] {
    motor.followPosition(5.0);
    highest = std::max(highest, motor.position());
  });
  EXPECT_EQ(motor.position(), 5.0);
  EXPECT_TRUE(motor.atRest());
  EXPECT_LT(highest, 5.0 + 1e-6);
}

TEST(Motor, AcceleratesNoFasterThanItsTorqueLessFriction) {
  Motor motor(parameters(), 0.0);
  steps(100, [&] { motor.followVelocity(40.0); });  // 50 ms
  EXPECT_NEAR(motor.velocity(), (2.0 - 0.1) * 100.0 * 0.05, 1e-6);
  EXPECT_DOUBLE_EQ(motor.torque(), 2.0);
  motor.limitTorque(0.6);
  steps(20, [&] { motor.followVelocity(40.0); });  // 10 ms
  EXPECT_NEAR(motor.velocity(), 9.5 + 0.5 * 100.0 * 0.01, 1e-6);
}

TEST(Motor, DoesNotMoveWithLessTorqueThanFriction) {
  Motor motor(parameters(), 1.0);
  motor.limitTorque(0.05);
  steps(1000, [&] { motor.followPosition(2.0); });
  EXPECT_EQ(motor.position(), 1.0);
  steps(1000, [&] { motor.applyTorque(0.09, 10.0); });
  EXPECT_EQ(motor.position(), 1.0);
}

TEST(Motor, CoastsToAStandByFriction) {
  Motor motor(parameters(), 0.0);
  steps(400, [&] { motor.followVelocity(10.0); });
  ASSERT_NEAR(motor.velocity(), 10.0, 1e-6);
  const double start = motor.position();
  steps(1000, [&] { motor.coast(); });  // 10 turns/s^2: 0.5 s
  EXPECT_NEAR(motor.velocity(), 5.0, 1e-6);
  steps(1001, [&] { motor.coast(); });
  EXPECT_TRUE(motor.atRest());
  EXPECT_NEAR(motor.position() - start, 5.0, 0.01);  // v^2 / (2 a)
}

TEST(Motor, TorqueAcceleratesUpToTheSpeedLimit) {
  Motor motor(parameters(), 0.0);
  steps(200, [&] { motor.applyTorque(0.5, 20.0); });  // 0.1 s
  EXPECT_NEAR(motor.velocity(), 0.4 * 100.0 * 0.1, 1e-6);
  steps(4000, [&] { motor.applyTorque(0.5, 20.0); });
  EXPECT_NEAR(motor.velocity(), 20.0, 0.05);
  steps(4000, [&] { motor.applyTorque(0.0, 20.0); });
  EXPECT_TRUE(motor.atRest());
}

// All of its torque, 2 * 100 turns/s^2, less 10 of friction: 0.95 turns/s after 5 ms.
TEST(Motor, RunsAwayFromItsDemandWhereItsPhasesAreSwapped) {
  Motor motor(parameters(), 0.0);
  motor.reverse(true);
  steps(10, [&] { motor.followPosition(0.0); });
  EXPECT_EQ(motor.position(), 0.0) << "it stands where it is to stand";
  steps(10, [&] { motor.followPosition(1.0); });
  EXPECT_NEAR(motor.velocity(), -0.95, 1e-9);
  steps(1000, [&] { motor.followPosition(1.0); });
  EXPECT_EQ(motor.velocity(), -50.0);
  EXPECT_LT(motor.position(), -10.0);
}

TEST(Motor, BlockedRotorPushesInVain) {
  Motor motor(parameters(), 0.0);
  motor.block(true);
  steps(100, [&] { motor.followPosition(1.0); });
  EXPECT_EQ(motor.position(), 0.0);
  EXPECT_DOUBLE_EQ(motor.torque(), 2.0);
  motor.block(false);
  steps(1000, [&] { motor.followPosition(1.0); });
  EXPECT_EQ(motor.position(), 1.0);
}

}  // namespace
}  // namespace cia402::sim
