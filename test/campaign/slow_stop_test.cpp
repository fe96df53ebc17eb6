// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The oracle that bounds stops. By docs/campaign.md a1, which turns at 1 rad/s when it is told to
// stop, may take 4 periods of 4 ms, in which it may gain 0.064 rad/s, and 1.2 * 1.064 / 4 + 0.15 s:
// 485 ms.
#include <gtest/gtest.h>

#include "oracle_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

class SlowStopTest : public OracleTest {
 protected:
  SlowStopTest() : OracleTest(makeSlowStops) {
    turn(1.0);
    look();
    mark();
  }
  void turn(double speed) {
    for (AxisTruth& truth : truths_) truth.velocity = speed;
  }
};

TEST_F(SlowStopTest, IsFoundWhoeverAskedForIt) {
  for (const char* const verb : {"halt", "disable", "quick_stop", "shutdown"}) {
    findings_.clear();
    mark();
    call(verb, "a1");
    lookFor(485ms);
    EXPECT_EQ(found(), "") << verb;
    look();
    EXPECT_EQ(found(), "slow_stop a1 +486 ms") << verb;
  }
}

TEST_F(SlowStopTest, IsNoneWhereTheMotorStandsInTime) {
  call("halt", "a1");
  lookFor(450ms);
  turn(0.019);  // below 2 % of its limit
  lookFor(40ms);
  turn(1.0);  // what it does later is no matter of this stop
  lookFor(1s);
  EXPECT_EQ(found(), "");
}

TEST_F(SlowStopTest, IsNoneOfAMotorThatNobodyStops) {
  for (const char* const verb : {"enable", "recover", "home", "set_mode", "read"}) call(verb, "a1");
  lookFor(1s);
  EXPECT_EQ(found(), "");
}

TEST_F(SlowStopTest, OfAMotorThatOnlyTurnsRoundIsFound) {
  call("halt", "a1");
  lookFor(200ms);
  turn(0.0);
  lookFor(20ms);
  turn(-0.5);
  lookFor(300ms);
  EXPECT_EQ(found(), "slow_stop a1 +486 ms");
}

TEST_F(SlowStopTest, IsNotMadeQuickerByAskingAgain) {
  call("halt", "a1");
  lookFor(200ms);
  call("quick_stop", "a1");
  lookFor(300ms);
  EXPECT_EQ(found(), "slow_stop a1 +486 ms");
}

// 1.2 * 0.564 / 4 + 0.15 + 0.016 s, but an effort may bring it to its limit meanwhile: 0.466 s.
TEST_F(SlowStopTest, IsBoundedByTheSpeedThatTheMotorMayHave) {
  turn(0.5);
  call("halt", "a1");
  lookFor(500ms);
  EXPECT_EQ(found(), "slow_stop a1 +336 ms");
  findings_.clear();
  truths_[0].mode = 10;  // cyclic torque
  mark();
  call("halt", "a1");
  lookFor(500ms);
  EXPECT_EQ(found(), "slow_stop a1 +467 ms");
}

TEST_F(SlowStopTest, OfAMotorWithoutPowerOrWithAFaultIsJudgedElsewhere) {
  call("halt", "all");
  lookFor(100ms);
  truths_[0].power = false;
  truths_[2].statusword = 0x0008;
  lookFor(10ms);
  truths_[0].power = true;
  truths_[2].statusword = 0x0027;
  lookFor(1s);
  EXPECT_EQ(found(), "");
}

TEST_F(SlowStopTest, OfAnAxisWithoutALimitOfAccelerationIsNotJudged) {
  call("halt", "a2");
  lookFor(10s);
  EXPECT_EQ(found(), "");
}

TEST_F(SlowStopTest, EndsWithACommandThatCameAfterIt) {
  call("halt", "a1");
  lookFor(9ms);  // more than two periods: not one that was under way
  permits_.allow(0, Permits::Source::stream, now() + 1s);
  lookFor(1s);
  EXPECT_EQ(found(), "");
}

TEST_F(SlowStopTest, DoesNotEndWithACommandThatWasUnderWay) {
  call("halt", "a1");
  lookFor(7ms);
  permits_.allow(0, Permits::Source::stream, now() + 1s);
  lookFor(500ms);
  EXPECT_EQ(found(), "slow_stop a1 +486 ms");
}

TEST_F(SlowStopTest, MayBeginAnewWhileItIsHindered) {
  const auto hinder = [&](Time until, int what) {
    if (what == 0) conditions_.lossy = until;
    if (what == 1) conditions_.foreign = until;
    if (what == 2) conditions_.host_late = until;
    if (what == 3) conditions_.axes[0].cut_off = until;
    if (what == 4) conditions_.axes[0].blocked = until;
    if (what == 5) conditions_.axes[0].unheard = until;
  };
  for (int what = 0; what < 6; ++what) {
    findings_.clear();
    mark();
    call("halt", "a1");
    hinder(now() + 100ms, what);  // counts for the last time 99 ms from now
    lookFor(600ms);
    EXPECT_EQ(found(), "slow_stop a1 +585 ms") << what;
  }
}

TEST_F(SlowStopTest, IsNotExcusedByTheEndOfTheProcess) {
  conditions_.ended = now() + 1s;
  call("shutdown", "all");
  lookFor(500ms);
  EXPECT_EQ(allFound(), "slow_stop a1 +486 ms, slow_stop a3 +486 ms");
}

}  // namespace
}  // namespace cia402::campaign
