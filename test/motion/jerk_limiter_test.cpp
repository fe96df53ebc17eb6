// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Set-points whose jerk is limited, too.
#include "motion/jerk_limiter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/limiter_fixture.h"
#include "motion/setpoint_limiter.h"

namespace cia402::motion {
namespace {

constexpr double kStepTime = 0.004;
constexpr Duration kStep = std::chrono::milliseconds(4);

/// 1 rad/s, 5 rad/s², 50 rad/s³, from -1.5 to 2 rad.
Joint smooth() {
  Joint joint = test::elbow();
  joint.limits.jerk = 50.0;
  return joint;
}

double restOf(const MotionState& from, double& seconds) {
  double position = from.position, velocity = from.velocity, acceleration = from.acceleration;
  seconds = 0;
  for (const JerkPiece& piece : brakingPieces(from, 5, 50)) {
    const double t = piece.time;
    position += velocity * t + acceleration * t * t / 2 + piece.jerk * t * t * t / 6;
    velocity += acceleration * t + piece.jerk * t * t / 2;
    acceleration += piece.jerk * t;
    EXPECT_LE(std::fabs(acceleration), 5 + 1e-12);
    seconds += t;
  }
  EXPECT_NEAR(velocity, 0, 1e-12);
  EXPECT_NEAR(acceleration, 0, 1e-12);
  return position;
}

TEST(BrakingPieces, BrakeAsFastAsBothLimitsPermit) {
  double seconds = 0;
  // 0.1 s to 5 rad/s², 0.1 s at it, 0.1 s back: v/2 (v/a + a/j)
  EXPECT_NEAR(restOf({0, 1, 0}, seconds), 0.15, 1e-12);
  EXPECT_NEAR(seconds, 0.3, 1e-12);
  EXPECT_NEAR(restOf({2, -1, 0}, seconds), 1.85, 1e-12);
  // Too slow to come to 5 rad/s²: 2 sqrt(v/j) s, v sqrt(v/j)
  EXPECT_NEAR(restOf({0, 0.02, 0}, seconds), 0.0004, 1e-12);
  EXPECT_NEAR(seconds, 0.04, 1e-12);
  // Half-way into that: 5 rad/s² and 0.75 rad/s are left to lose by what began
  EXPECT_NEAR(restOf({0, 0.75, -5}, seconds), 0.75 * 0.1 - 0.025 + 0.25 * 0.1 / 3, 1e-12);
  EXPECT_NEAR(seconds, 0.2, 1e-12);
  // Its acceleration alone takes the velocity through nothing: 0.01 - 1/100 and it is done
  EXPECT_NEAR(restOf({0, 0.01, -1}, seconds), 0.01 * 0.02 - 0.0002 + 50 * 8e-6 / 6, 1e-15);
  EXPECT_NEAR(seconds, 0.02, 1e-12);
  EXPECT_EQ(restOf({0.5, 0, 0}, seconds), 0.5);
}

TEST(BrakingPieces, TurnBackWhatAccelerationAloneHasMadeTooFast) {
  double seconds = 0;
  restOf({0, 0, 4}, seconds);
  EXPECT_GT(seconds, 2 * 4 / 50.0);
  restOf({0, 0.05, -4}, seconds);
  EXPECT_GT(seconds, 4 / 50.0);
}

/// Runs a limiter at a steady cycle and judges the differences of what it gives, as a drive sees
/// them.
struct Judged {
  explicit Judged(const Joint& of, double from = 0)
      : joint(of), limiter(of), last{from, from, from} {
    limiter.reset({from, 0, 0}, now);
  }
  double step() {
    const double next = limiter.step(now += kStep).position;
    const double v1 = (last[1] - last[0]) / kStepTime, v2 = (last[2] - last[1]) / kStepTime;
    const double v3 = (next - last[2]) / kStepTime;
    top_speed = std::max(top_speed, std::fabs(v3));
    top_acceleration = std::max(top_acceleration, std::fabs(v3 - v2) / kStepTime);
    top_jerk = std::max(top_jerk, std::fabs(v3 - 2 * v2 + v1) / kStepTime / kStepTime);
    lowest = std::min(lowest, next);
    highest = std::max(highest, next);
    last[0] = last[1];
    last[1] = last[2];
    return last[2] = next;
  }
  double follow(double command) {
    EXPECT_TRUE(limiter.command(command));
    return step();
  }
  void expectWithinLimits() const {
    EXPECT_LE(top_speed, *joint.limits.velocity * (1 + 1e-9));
    EXPECT_LE(top_acceleration, *joint.limits.acceleration * (1 + 1e-6));
    EXPECT_LE(top_jerk, *joint.limits.jerk * (1 + 1e-4));
    EXPECT_LE(highest, *joint.limits.upper);
    EXPECT_GE(lowest, *joint.limits.lower);
  }

  Joint joint;
  PositionLimiter limiter;
  Time now{};
  double last[3];
  double top_speed = 0, top_acceleration = 0, top_jerk = 0, lowest = 0, highest = 0;
};

TEST(JerkLimitedPosition, AStepTakesAsLongAsItMust) {
  Judged joint(smooth());
  joint.follow(1);
  int cycles = 1;
  while (std::fabs(joint.step() - 1) > 1e-6 && cycles < 1000) ++cycles;
  // 1 rad at 1 rad/s, 5 rad/s² and 50 rad/s³: 1/1 + 1/5 + 5/50 s = 325 cycles
  EXPECT_NEAR(cycles, 325, 4);
  for (int i = 0; i < 50; ++i) joint.step();
  EXPECT_NEAR(joint.last[2], 1, 1e-9);
  EXPECT_EQ(joint.last[2], joint.last[1]);
  EXPECT_LE(joint.highest, 1 + 1e-9);
  EXPECT_GT(joint.top_jerk, 49);
  joint.expectWithinLimits();
}

TEST(JerkLimitedPosition, AStreamThatKeepsTheLimitsIsFollowedClosely) {
  Judged joint(smooth());
  double furthest = 0;
  for (int i = 1; i <= 2000; ++i) {
    const double t = i * kStepTime;
    const double begun = t < 1 ? t * t * t * (10 - 15 * t + 6 * t * t) : 1;  // sets off smoothly
    const double command = 0.4 * begun * std::sin(2 * t);
    const double error = std::fabs(joint.follow(command) - command);
    if (t > 1.5) furthest = std::max(furthest, error);
  }
  // It accelerates with up to 1.6 rad/s²: a³/j² is 1.6 mrad, at 0.8 rad/s the way of 2 ms.
  EXPECT_LT(furthest, 1.6e-3);
  joint.expectWithinLimits();
}

TEST(JerkLimitedPosition, AStreamThatEndsAtSpeedIsNotTurnedBackTo) {
  Judged joint(smooth());
  double command = 0;
  for (int i = 0; i < 500; ++i) joint.follow(command += 0.5 * kStepTime * std::min(1.0, i / 100.0));
  double before = joint.last[2];
  for (int i = 0; i < 200; ++i) {
    const double next = joint.step();
    EXPECT_GE(next, before - 1e-12) << i;
    before = next;
  }
  EXPECT_EQ(joint.limiter.step(joint.now += kStep).velocity, 0);
  EXPECT_EQ(joint.limiter.goal(), before);
  joint.expectWithinLimits();
}

TEST(JerkLimitedPosition, FromOutsideItOnlyComesBack) {
  Judged joint(smooth(), 2.2);
  for (int i = 0; i < 100; ++i) EXPECT_LE(joint.follow(3), 2.2);
  EXPECT_EQ(joint.last[2], 2.2);
  for (int i = 0; i < 500; ++i) EXPECT_LE(joint.follow(1.9), 2.2);
  EXPECT_NEAR(joint.last[2], 1.9, 1e-6);
  for (int i = 0; i < 500; ++i) EXPECT_LE(joint.follow(3), 2.0);
  EXPECT_NEAR(joint.last[2], 2.0, 1e-6);
}

// Whatever leads it back for a moment, what would lead it out again leaves it at rest.
TEST(JerkLimitedPosition, OutsideItComesToRestWhenItIsToldToGoFurtherOutAgain) {
  for (const double side : {1.0, -1.0}) {
    for (int led = 1; led <= 60; ++led) {
      for (const int told : {1, 2, 7}) {
        SCOPED_TRACE(std::to_string(side * led) + " cycles, " + std::to_string(told));
        Judged joint(smooth(), 2.2 * side);
        for (int i = 0; i < led; ++i) joint.follow(1.9 * side);
        for (int i = 0; i < told; ++i) joint.follow(3 * side);
        double before = joint.last[2];
        for (int i = 0; i < 400; ++i) {
          const double next = joint.step();
          EXPECT_LE(side * next, std::max(2.0, side * before)) << "within the limits it may return";
          before = next;
        }
        EXPECT_EQ(joint.limiter.step(joint.now += kStep).velocity, 0);
        EXPECT_EQ(joint.step(), before);
        EXPECT_NEAR(before, *joint.limiter.goal(), 1e-9);
      }
    }
  }
}

class EveryJerkSeed : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, EveryJerkSeed, testing::Values(1U, 2U, 3U, 4U, 5U));
constexpr int kStormCycles = 40000;

TEST_P(EveryJerkSeed, FromOutsideItComesToRestWhateverItWasTold) {
  test::Storm storm(GetParam());
  for (int run = 0; run < 200; ++run) {
    SCOPED_TRACE(run);
    const double side = run % 2 == 0 ? 1 : -1;
    PositionLimiter limiter(smooth());
    Time now{};
    limiter.reset({side * (2.3 + storm.random(0.3)), 0, 0}, now);
    double outermost = 3;
    const int told = static_cast<int>(40 + storm.random(40));
    for (int i = 0; i < told + 2000; ++i) {
      const auto command = i < told ? storm.command(4) : std::nullopt;
      if (command) static_cast<void>(limiter.command(*command));
      const double at = side * limiter.step(now += storm.cycle()).position;
      ASSERT_LE(at, outermost + 1e-12) << i;
      outermost = std::max(side > 0 ? 2.0 : 1.5, at);
    }
    const MotionState end = limiter.step(now += kStep);
    EXPECT_EQ(end.velocity, 0);
    EXPECT_NEAR(end.position, limiter.goal().value_or(end.position), 1e-9);
  }
}

TEST_P(EveryJerkSeed, PositionsKeepAllLimits) {
  test::Storm storm(GetParam());
  Judged joint(smooth());
  for (int i = 0; i < kStormCycles; ++i) {
    if (const auto command = storm.command(4)) static_cast<void>(joint.limiter.command(*command));
    ASSERT_TRUE(std::isfinite(joint.step())) << i;
  }
  joint.expectWithinLimits();
  // The storm did drive the joint to its limits.
  EXPECT_GT(joint.top_speed, 0.99);
  EXPECT_GT(joint.top_acceleration, 4.9);
  EXPECT_GT(joint.top_jerk, 49);
  EXPECT_GT(joint.highest, 2 - 1e-3);
  EXPECT_LT(joint.lowest, -1.5 + 1e-3);
}

TEST_P(EveryJerkSeed, VelocitiesKeepAllLimits) {
  test::Storm storm(GetParam());
  VelocityLimiter limiter(smooth(), 3 * kStep);
  Time now{};
  limiter.reset({}, now);
  double position = 0, velocity = 0, before = 0, told[2] = {0, 0};
  double top_speed = 0, top_acceleration = 0, top_jerk = 0, lowest = 0, highest = 0;
  for (int i = 0; i < kStormCycles; ++i) {
    if (const auto command = storm.command(3)) static_cast<void>(limiter.command(*command));
    const double next = limiter.step(now += kStep, told[0]).velocity;  // of two cycles ago
    told[0] = told[1];
    told[1] = position;
    const double acceleration = (next - velocity) / kStepTime;
    top_speed = std::max(top_speed, std::fabs(next));
    top_acceleration = std::max(top_acceleration, std::fabs(acceleration));
    top_jerk = std::max(top_jerk, std::fabs(acceleration - before) / kStepTime);
    position += velocity * kStepTime;
    lowest = std::min(lowest, position);
    highest = std::max(highest, position);
    before = acceleration;
    velocity = next;
  }
  EXPECT_LE(top_speed, 1 + 1e-9);
  EXPECT_LE(top_acceleration, 5 + 1e-6);
  EXPECT_LE(top_jerk, 50 + 1e-3);
  EXPECT_LE(highest, 2 + 1e-6);
  EXPECT_GE(lowest, -1.5 - 1e-6);
  EXPECT_GT(top_speed, 0.99);
  EXPECT_GT(top_jerk, 49);
  EXPECT_GT(highest, 2 - 1e-2);
}

/// A velocity that leads to a limit, with feedback that is coarse and two cycles old.
double restAtLimit(double jerk, double resolution) {
  Joint joint = smooth();
  joint.limits.jerk = jerk;
  VelocityLimiter limiter(joint, 3 * kStep);
  Time now{};
  limiter.reset({}, now);
  double position = 0, velocity = 0, told[2] = {0, 0};
  for (int i = 0; i < 10000; ++i) {
    EXPECT_TRUE(limiter.command(0.8));
    const double seen = std::round(told[0] / resolution) * resolution;
    const double next = limiter.step(now += kStep, seen).velocity;
    told[0] = told[1];
    told[1] = position;
    position += velocity * kStepTime;
    velocity = next;
    EXPECT_LE(position, 2.0);
    if (i > 5000 && std::fabs(velocity) > 1e-8) ADD_FAILURE() << "it swings";
  }
  return position;
}

TEST(JerkLimitedVelocity, ComesToRestAtALimitAndStaysThere) {
  for (const double jerk : {20.0, 100.0, 500.0, 2000.0}) {
    for (const double resolution : {1e-9, 1e-5, 1e-4}) {
      const double margin = jerk * std::pow(0.012, 3) / 4;
      EXPECT_NEAR(restAtLimit(jerk, resolution), 2 - margin, 1.5 * resolution)
          << jerk << " " << resolution;
    }
  }
}

TEST_P(EveryJerkSeed, AConstantTargetIsReachedWithoutOvershoot) {
  test::Storm storm(GetParam());
  for (int run = 0; run < 50; ++run) {
    const double from = storm.random(1.4), target = storm.random(1.4);
    const double sign = target >= from ? 1 : -1;
    Judged joint(smooth(), from);
    double before = from;
    for (int i = 0; i < 1000; ++i) {
      const double position = joint.follow(target);
      ASSERT_LE(sign * (position - target), 1e-8) << i;
      ASSERT_GE(sign * (position - before), -1e-8) << i;
      before = position;
    }
    ASSERT_NEAR(before, target, 1e-8);
  }
}

}  // namespace
}  // namespace cia402::motion
