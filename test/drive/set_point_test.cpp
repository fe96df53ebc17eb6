// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/set_point.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace cia402::drive {
namespace {

using std::chrono::milliseconds;

constexpr Duration kStepTime = milliseconds(10);
constexpr double kVelocity = 2.0, kDeceleration = 4.0;

motion::JointLimits limits() { return {-1.0, 1.0, kVelocity, {}, {}, {}, false}; }

struct Rig {
  explicit Rig(SetPointKind kind, double value = 0.0) : point(limits(), kDeceleration, kStepTime) {
    point.rest(kind, value);
  }
  void cycle() { point.advance(now += kStepTime); }
  void cycles(int count) {
    for (int i = 0; i < count; ++i) cycle();
  }
  /// A stream that moves at `velocity` for so many cycles.
  void move(double velocity, int count) {
    for (int i = 0; i < count; ++i) {
      point.give(point.value() + velocity * toSeconds(kStepTime));
      cycle();
    }
  }
  SetPoint point;
  Time now{std::chrono::seconds(1)};
};

TEST(SetPoint, AStreamStandsWhereItWasGivenWhileItIsRenewed) {
  Rig rig(SetPointKind::stream);
  rig.move(1.0, 10);
  EXPECT_NEAR(rig.point.value(), 0.1, 1e-12);
  EXPECT_NEAR(rig.point.velocity(), 1.0, 1e-9);
  EXPECT_FALSE(rig.point.atRest());
  EXPECT_EQ(rig.point.movedAt(), rig.now);
}

TEST(SetPoint, AStreamThatIsNotRenewedIsRampedToRest) {
  Rig rig(SetPointKind::stream);
  rig.move(1.0, 10);
  const std::uint32_t breaks = rig.point.breaks();
  rig.cycles(40);
  EXPECT_TRUE(rig.point.atRest());
  EXPECT_NEAR(rig.point.value(), 0.1 + 1.0 / (2 * kDeceleration), 1e-9);  // v²/2a
  EXPECT_EQ(rig.point.breaks(), breaks + 1);
}

TEST(SetPoint, AStreamIsStoppedAsGentlyAsTheTimeAllows) {
  Rig rig(SetPointKind::stream);
  rig.move(1.0, 10);
  rig.point.stop(milliseconds(500));  // 2 /s² of the 4 that there are
  rig.cycles(25);
  EXPECT_NEAR(rig.point.velocity(), 0.5, 1e-9);
  rig.cycles(25);
  EXPECT_TRUE(rig.point.atRest());
  EXPECT_NEAR(rig.point.value(), 0.1 + 0.25, 1e-9);
}

TEST(SetPoint, AGentleStopIsNoHarderThanTheDeceleration) {
  Rig rig(SetPointKind::stream);
  rig.move(1.0, 10);
  rig.point.stop(milliseconds(10));
  rig.cycles(24);
  EXPECT_FALSE(rig.point.atRest());
  rig.cycles(1);
  EXPECT_NEAR(rig.point.value(), 0.1 + 1.0 / (2 * kDeceleration), 1e-9);
}

TEST(SetPoint, AGentleStopEndsInFrontOfALimit) {
  Rig rig(SetPointKind::stream, 0.7);
  rig.move(1.0, 10);  // to 0.8; the limit is 1
  rig.point.stop(std::chrono::seconds(2));
  rig.cycles(39);
  EXPECT_FALSE(rig.point.atRest());
  EXPECT_NEAR(rig.point.velocity(), 0.025, 1e-9) << "2.5 /s²";
  rig.cycles(1);
  EXPECT_TRUE(rig.point.atRest());
  EXPECT_NEAR(rig.point.value(), 1.0, 1e-9);
}

/// From rest at 0 with all of the acceleration to the middle, and from there with all of it to the
/// limit, 1.
double wayToTheLimit(double time) {
  const double half = std::sqrt(0.5 / (0.5 * kDeceleration));
  if (time < half) return 0.5 * kDeceleration * time * time;
  const double left = std::max(2.0 * half - time, 0.0);
  return 1.0 - 0.5 * kDeceleration * left * left;
}

TEST(SetPoint, AStopOfWhatBrakesTowardsALimitBrakesNoHarder) {
  const double dt = toSeconds(kStepTime);
  for (int stopped = 2; stopped < 105; ++stopped) {
    Rig rig(SetPointKind::stream);
    double last = rig.point.value(), step = 0.0, hardest = 0.0;
    for (int i = 1; i < 200; ++i) {
      if (i < stopped) rig.point.give(wayToTheLimit(i * dt));
      if (i == stopped || i == stopped + 3) rig.point.stop();
      rig.cycle();
      const double next = rig.point.value() - last;
      hardest = std::max(hardest, std::abs(next - step));
      last = rig.point.value();
      step = next;
    }
    EXPECT_LE(hardest, kDeceleration * dt * dt * (1.0 + 1e-6)) << "stopped in cycle " << stopped;
    EXPECT_LE(last, 1.0);
    EXPECT_TRUE(rig.point.atRest());
  }
}

TEST(SetPoint, AGentleStopIsHastenedByAHarderOne) {
  Rig rig(SetPointKind::stream);
  rig.move(1.0, 10);
  rig.point.stop(milliseconds(500));
  rig.cycles(25);  // 0.5 /s
  const std::uint32_t breaks = rig.point.breaks();
  rig.point.stop(std::chrono::seconds(9));
  rig.cycles(1);
  EXPECT_NEAR(rig.point.velocity(), 0.48, 1e-9) << "never made gentler";
  rig.point.stop();
  rig.cycles(11);
  EXPECT_NEAR(rig.point.velocity(), 0.04, 1e-9);
  rig.cycles(1);
  EXPECT_TRUE(rig.point.atRest());
  EXPECT_EQ(rig.point.breaks(), breaks);
}

TEST(SetPoint, WhereAGentleStopLeadsIsExpected) {
  Rig rig(SetPointKind::stream);
  rig.move(1.0, 10);
  rig.point.stop(milliseconds(500));
  rig.cycles(10);
  const SetPoint::Motion then = rig.point.expected(milliseconds(200));
  rig.cycles(20);
  EXPECT_NEAR(rig.point.value(), then.position, 1e-9);
  EXPECT_NEAR(rig.point.velocity(), then.velocity, 1e-9);
}

TEST(SetPoint, AGentleStopGoesOnWithAnotherZero) {
  Rig rig(SetPointKind::stream, -0.5);
  rig.move(1.0, 10);
  rig.point.stop(milliseconds(500));
  rig.cycles(10);
  rig.point.shift(0.25);
  rig.cycles(40);
  EXPECT_TRUE(rig.point.atRest());
  EXPECT_NEAR(rig.point.value(), -0.4 + 0.25 + 0.25, 1e-9);
}

TEST(SetPoint, SlowsAVelocityDownByTheDecelerationWhereItIsNotRenewed) {
  Rig rig(SetPointKind::velocity);
  rig.point.give(1.0);
  rig.cycle();
  EXPECT_EQ(rig.point.value(), 1.0);
  rig.cycle();
  EXPECT_NEAR(rig.point.value(), 1.0 - kDeceleration * 0.01, 1e-12);
  rig.cycles(30);
  EXPECT_EQ(rig.point.value(), 0.0);
  EXPECT_TRUE(rig.point.atRest());
}

TEST(SetPoint, TakesOverAMotorThatTurnsAndRampsItToRest) {
  Rig rig(SetPointKind::torque);
  rig.point.arrest(-1.0);
  EXPECT_EQ(rig.point.kind(), SetPointKind::velocity);
  EXPECT_EQ(rig.point.value(), -1.0);
  EXPECT_FALSE(rig.point.atRest());
  rig.cycle();
  EXPECT_NEAR(rig.point.value(), -1.0 + kDeceleration * 0.01, 1e-12);
  rig.cycles(30);
  EXPECT_EQ(rig.point.value(), 0.0);
  EXPECT_TRUE(rig.point.atRest());
}

TEST(SetPoint, DropsATorqueAtOnceWhereItIsNotRenewed) {
  Rig rig(SetPointKind::torque);
  rig.point.give(3.0);
  rig.cycle();
  EXPECT_EQ(rig.point.value(), 3.0);
  rig.cycle();
  EXPECT_EQ(rig.point.value(), 0.0);
}

TEST(SetPoint, LeavesAGoalToTheDrive) {
  Rig rig(SetPointKind::goal);
  rig.point.give(0.7);
  rig.cycles(100);
  EXPECT_EQ(rig.point.value(), 0.7);
  EXPECT_TRUE(rig.point.atRest());
  EXPECT_EQ(rig.point.movedAt(), Time(std::chrono::seconds(1)) + kStepTime);
}

TEST(SetPoint, StepsNoFurtherThanTheVelocityLimitAllows) {
  Rig rig(SetPointKind::stream);
  rig.point.give(0.5);
  rig.cycle();
  EXPECT_NEAR(rig.point.value(), kVelocity * 0.01, 1e-6);
}

TEST(SetPoint, ASecondStopChangesNothing) {
  Rig once(SetPointKind::stream), twice(SetPointKind::stream);
  for (Rig* rig : {&once, &twice}) rig->move(1.5, 10);
  once.point.stop();
  twice.point.stop();
  for (int i = 0; i < 60; ++i) {
    once.cycle();
    twice.point.stop();
    twice.cycle();
    ASSERT_EQ(once.point.value(), twice.point.value()) << i;
  }
  EXPECT_TRUE(twice.point.atRest());
}

TEST(SetPoint, AfterMissedCyclesAStreamStandsAtWhatWasSentLast) {
  Rig rig(SetPointKind::stream);
  rig.move(1.5, 10);
  rig.point.stop();
  rig.cycles(3);
  const double sent = rig.point.value();
  rig.now += milliseconds(150);
  rig.point.interrupt();
  rig.cycles(20);
  EXPECT_EQ(rig.point.value(), sent);
  EXPECT_TRUE(rig.point.atRest());
  EXPECT_EQ(rig.point.interruptions(), 1u);
}

TEST(SetPoint, AfterMissedCyclesAVelocityGoesOnWithItsRamp) {
  Rig rig(SetPointKind::velocity);
  rig.point.give(1.0);
  rig.cycle();
  rig.point.stop();
  rig.cycle();
  rig.now += milliseconds(150);
  rig.point.interrupt();
  rig.cycle();
  EXPECT_NEAR(rig.point.value(), 1.0 - 2 * kDeceleration * 0.01, 1e-12);
}

TEST(SetPoint, ANewZeroShiftsARampUnderWay) {
  Rig rig(SetPointKind::stream), shifted(SetPointKind::stream);
  for (Rig* r : {&rig, &shifted}) {
    r->move(1.0, 10);
    r->point.stop();
    r->cycles(3);
  }
  shifted.point.shift(0.3);
  for (int i = 0; i < 40; ++i) {
    rig.cycle();
    shifted.cycle();
    ASSERT_NEAR(shifted.point.value(), rig.point.value() + 0.3, 1e-9);
  }
}

TEST(SetPoint, AStopEndsAtTheLimitOfTheJoint) {
  Rig rig(SetPointKind::stream, 0.9);
  rig.move(2.0, 4);  // 0.98, and half a metre of braking distance
  rig.point.stop();
  rig.cycles(60);
  EXPECT_NEAR(rig.point.value(), 1.0, 1e-12);
}

TEST(SetPoint, TellsWhereAStopWillBringIt) {
  Rig rig(SetPointKind::stream);
  rig.move(1.0, 10);
  const SetPoint::Motion half = rig.point.expected(milliseconds(125));
  EXPECT_NEAR(half.velocity, 0.5, 1e-9);
  EXPECT_NEAR(half.position, 0.1 + 0.125 * 0.75, 1e-9);
  const SetPoint::Motion end = rig.point.expected(std::chrono::seconds(5));
  EXPECT_EQ(end.velocity, 0.0);
  EXPECT_NEAR(end.position, 0.1 + 1.0 / (2 * kDeceleration), 1e-9);
}

TEST(SetPoint, AStopDropsWhatWasGivenForTheNextCycle) {
  Rig rig(SetPointKind::goal, 0.1);
  rig.point.give(0.7);
  rig.point.stop();
  rig.cycle();
  EXPECT_EQ(rig.point.value(), 0.1);
}

TEST(SetPoint, ANewZeroDropsWhatWasGivenInTheOldOne) {
  Rig rig(SetPointKind::goal, 0.1);
  rig.point.give(0.7);
  rig.point.shift(0.3);
  rig.cycle();
  EXPECT_NEAR(rig.point.value(), 0.4, 1e-12);
}

TEST(SetPoint, CountsEachThingThatEndsAMotion) {
  Rig rig(SetPointKind::stream);
  std::uint32_t breaks = rig.point.breaks();
  rig.point.rest(SetPointKind::stream, 0.0);
  EXPECT_EQ(rig.point.breaks(), ++breaks) << "a new beginning";
  rig.move(1.0, 10);
  EXPECT_EQ(rig.point.breaks(), breaks);
  rig.point.stop();
  EXPECT_EQ(rig.point.breaks(), ++breaks);
  rig.point.stop();
  rig.cycles(60);
  rig.point.stop();
  EXPECT_EQ(rig.point.breaks(), breaks) << "it is being stopped, or at rest";
  rig.point.shift(0.1);
  EXPECT_EQ(rig.point.breaks(), ++breaks) << "another zero";
}

TEST(SetPoint, MissedCyclesInterruptNothingThatRests) {
  Rig rig(SetPointKind::stream);
  rig.point.interrupt();
  EXPECT_EQ(rig.point.interruptions(), 0u);
  rig.move(1.0, 10);
  rig.point.stop();
  rig.cycles(60);
  rig.point.interrupt();
  EXPECT_EQ(rig.point.interruptions(), 0u) << "its ramp is over";
}

}  // namespace
}  // namespace cia402::drive
