// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The oracles that look at the motors alone find what they are for, and nothing just within their
// bounds, which are computed here from docs/campaign.md.
#include <gtest/gtest.h>

#include "oracle_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

class CommandedMotionTest : public OracleTest {
 protected:
  CommandedMotionTest() : OracleTest(makeCommandedMotion) {
    look();
    mark();
  }
  void turn(double by) {
    truths_[0].position += by;
    look();
  }
};

// 0.5 % of 1 rad/s and three counts: 0.00509 rad.
TEST_F(CommandedMotionTest, ThatNobodyCommandedIsFound) {
  turn(0.0053);
  EXPECT_EQ(found(), "uncommanded_motion a1 +1 ms");
}

TEST_F(CommandedMotionTest, BackwardsIsFound) {
  turn(-0.0053);
  EXPECT_EQ(found(), "uncommanded_motion a1 +1 ms");
}

TEST_F(CommandedMotionTest, OfLessThanTheBoundIsNot) {
  turn(0.005);
  EXPECT_EQ(found(), "");
}

TEST_F(CommandedMotionTest, ThatCreepsOnIsFoundOnceItAddsUp) {
  for (int i = 0; i < 20; ++i) turn(0.0005);
  EXPECT_EQ(found(), "uncommanded_motion a1 +11 ms") << "after 5.5 mrad";
}

TEST_F(CommandedMotionTest, GoesOnNoLongerThanItIsPermitted) {
  permits_.allow(0, Permits::Source::stream, now() + 10ms);
  for (int i = 0; i < 10; ++i) turn(0.001);
  turn(0.001);  // from here on it should rest
  for (int i = 0; i < 5; ++i) turn(0.001);
  EXPECT_EQ(found(), "") << "5 mrad after the permit";
  turn(0.001);
  EXPECT_EQ(found(), "uncommanded_motion a1 +17 ms");
}

TEST_F(CommandedMotionTest, WithoutPowerIsNobodysAndCountsFromWhenThePowerReturns) {
  truths_[0].power = false;
  for (int i = 0; i < 10; ++i) turn(0.1);
  truths_[0].power = true;
  turn(0.1);
  EXPECT_EQ(found(), "");
  turn(0.0053);
  EXPECT_EQ(found(), "uncommanded_motion a1 +12 ms");
}

TEST_F(CommandedMotionTest, OfARotorThatWasBlockedIsExcusedSoLong) {
  conditions_.axes[0].blocked = now() + 10ms;
  for (int i = 0; i < 9; ++i) turn(0.1);
  turn(0.1);
  EXPECT_EQ(found(), "");
  turn(0.0053);
  EXPECT_EQ(found(), "uncommanded_motion a1 +11 ms");
}

TEST_F(CommandedMotionTest, OfOneAxisIsNotExcusedByAnother) {
  permits_.allow(1, Permits::Source::stream, now() + 1s);
  conditions_.axes[2].blocked = now() + 1s;
  turn(0.0053);
  EXPECT_EQ(found(), "uncommanded_motion a1 +1 ms");
}

class PowerTest : public OracleTest {
 protected:
  PowerTest() : OracleTest(makePowerOracle) {}
  /// The power stage goes from one state to the other at that speed.
  void change(bool to, double speed) {
    truths_[0].velocity = 0.0;
    truths_[0].power = !to;
    look();
    mark();
    truths_[0].velocity = speed;
    truths_[0].power = to;
    look();
  }
};

TEST_F(PowerTest, ThatGoesOffInMotionIsFound) {
  change(false, 0.06);  // 5 % of 1 rad/s
  EXPECT_EQ(found(), "power_at_speed a1 +1 ms");
}

TEST_F(PowerTest, ThatGoesOffBelowTheBoundIsNot) {
  change(false, 0.049);
  change(false, -0.049);
  EXPECT_EQ(found(), "");
}

TEST_F(PowerTest, ThatComesOnInMotionIsFound) {
  change(true, -0.06);
  EXPECT_EQ(found(), "power_at_speed a1 +1 ms");
}

TEST_F(PowerTest, ThatComesOnBelowTheBoundIsNot) {
  change(true, 0.049);
  EXPECT_EQ(found(), "");
}

TEST_F(PowerTest, ThatStaysAsItIsIsNoMatterHowFastTheMotorTurns) {
  look();
  truths_[0].velocity = 1.0;
  lookFor(10ms);
  truths_[0].velocity = 0.0;
  truths_[0].power = false;
  look();
  truths_[0].velocity = 1.0;
  lookFor(10ms);
  EXPECT_EQ(found(), "");
}

TEST_F(PowerTest, MayGoOffByItselfWhileTheAxisMayCoast) {
  conditions_.axes[0].may_coast = now() + 20ms;
  wait(17ms);
  change(false, 0.5);
  EXPECT_EQ(found(), "") << "19 ms later";
}

TEST_F(PowerTest, MayNotGoOffByItselfAfterThat) {
  conditions_.axes[0].may_coast = now() + 20ms;
  wait(18ms);
  change(false, 0.5);
  EXPECT_EQ(found(), "power_at_speed a1 +1 ms") << "20 ms later";
}

TEST_F(PowerTest, MayNotComeOnWhileTheAxisCoasts) {
  conditions_.axes[0].may_coast = now() + 20ms;
  change(true, 0.5);
  EXPECT_EQ(found(), "power_at_speed a1 +1 ms");
}

class EffortTest : public OracleTest {
 protected:
  EffortTest() : OracleTest(makeEffortLimits) {}
  void drive(std::size_t axis, double effort) {
    truths_[axis].effort = effort;
    look();
  }
};

// 1.02 times 10 N m and two counts of 0.05 N m: 10.3 N m.
TEST_F(EffortTest, BeyondTheLimitIsFound) {
  drive(0, 10.31);
  EXPECT_EQ(found(), "effort_limit a1 +1 ms");
}

TEST_F(EffortTest, BeyondTheLimitBackwardsIsFound) {
  drive(0, -10.31);
  EXPECT_EQ(found(), "effort_limit a1 +1 ms");
}

TEST_F(EffortTest, WithinTheBoundIsNot) {
  drive(0, 10.29);
  drive(0, -10.29);
  EXPECT_EQ(found(), "");
}

TEST_F(EffortTest, OfADriveWithFloatsHasNoCountsToSpare) {
  drive(2, 5.09);
  EXPECT_EQ(found(), "");
  drive(2, 5.11);
  EXPECT_EQ(found(), "effort_limit a3 +2 ms");
}

TEST_F(EffortTest, WithoutPowerIsNoneOfTheDrive) {
  truths_[0].power = false;
  drive(0, 100.0);
  EXPECT_EQ(found(), "");
  truths_[0].power = true;
  look();
  EXPECT_EQ(found(), "effort_limit a1 +2 ms");
}

TEST_F(EffortTest, WithoutALimitIsNotJudged) {
  drive(1, 1e6);
  EXPECT_EQ(found(), "");
}

TEST_F(EffortTest, IsLimitedInEveryMode) {
  truths_[0].mode = 10;  // cyclic_torque
  drive(0, 10.31);
  EXPECT_EQ(found(), "effort_limit a1 +1 ms");
}

}  // namespace
}  // namespace cia402::campaign
