// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What may move an axis, and until when, by what is seen of its motor; player_test.cpp has
// what is commanded and answered.
#include "campaign/permits.h"

#include <gtest/gtest.h>

#include "oracle_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;
using Source = Permits::Source;

class PermitsTest : public testing::Test {
 protected:
  PermitsTest() {
    for (AxisTruth& truth : truths_) {
      truth.statusword = 0x0027;
      truth.power = true;
    }
    wait(1s);
  }
  Time now() const { return stage_.now(); }
  /// Looks at the motors each millisecond meanwhile.
  void wait(Duration duration) {
    for (const Time end = now() + duration; now() < end;) {
      stage_.host().advance(now() + 1ms);
      permits_.watch(truths_, now());
    }
  }
  bool mayMove(std::size_t axis = 0) const { return permits_.allowed(axis, now()); }
  /// It may move so long from now, to the millisecond.
  void expectFor(Duration duration) {
    wait(duration - 1ms);
    EXPECT_TRUE(mayMove()) << "too short";
    wait(3ms);
    EXPECT_FALSE(mayMove()) << "too long";
  }

  Stage stage_{loadedRobot(kJudgedRobot), 1};
  Permits permits_{stage_};
  std::vector<AxisTruth> truths_{stage_.axes().size()};
};

TEST_F(PermitsTest, AreNoneAtFirst) { EXPECT_FALSE(mayMove()); }

TEST_F(PermitsTest, LastUntilTheirEndForTheirAxisAlone) {
  permits_.allow(0, Source::stream, now() + 100ms);
  EXPECT_FALSE(mayMove(1));
  expectFor(100ms);
}

TEST_F(PermitsTest, AreNotShortenedByAShorterOne) {
  permits_.allow(0, Source::stream, now() + 100ms);
  permits_.allow(0, Source::stream, now() + 10ms);
  permits_.allow(0, Source::trajectory, now() + 20ms);
  expectFor(100ms);
}

TEST_F(PermitsTest, OfOneSourceEndAndLeaveTheOthers) {
  permits_.allow(0, Source::stream, now() + 500ms);
  permits_.allow(0, Source::homing, kNever);
  permits_.cut(0, Source::homing, now());
  wait(100ms);
  EXPECT_TRUE(mayMove());
  permits_.cut(0, now() + 20ms);
  expectFor(20ms);
}

TEST_F(PermitsTest, AreNotLengthenedByACut) {
  permits_.allow(0, Source::stream, now() + 20ms);
  permits_.cut(0, now() + 500ms);
  expectFor(20ms);
}

TEST_F(PermitsTest, ThatHaveNotEndedAreProlonged) {
  permits_.prolong(0, Source::trajectory, now() + 100ms);
  EXPECT_FALSE(mayMove()) << "there was none";
  permits_.allow(0, Source::trajectory, now() + 20ms);
  permits_.prolong(0, Source::trajectory, now() + 10ms);
  permits_.prolong(0, Source::trajectory, now() + 50ms);
  expectFor(50ms);
  permits_.prolong(0, Source::trajectory, now() + 50ms);
  EXPECT_FALSE(mayMove()) << "it is over";
}

TEST_F(PermitsTest, OfATargetEndOnceTheMotorStoodFor400Ms) {
  permits_.allow(0, Source::target, now() + 10s);
  truths_[0].velocity = 0.5;
  wait(1s);
  truths_[0].velocity = 0.021;  // 2 % of 1 rad/s, and 0.002
  expectFor(401ms);
}

TEST_F(PermitsTest, OfATargetEndWhereTheMotorNeverSetOff) {
  permits_.allow(0, Source::target, now() + 10s);
  expectFor(401ms);
}

TEST_F(PermitsTest, OfATargetStayWhileTheMotorMoves) {
  permits_.allow(0, Source::target, now() + 3s);
  truths_[0].velocity = -0.05;
  expectFor(3s);
}

TEST_F(PermitsTest, OfATargetAreNotUsedUpWhileARotorIsBlocked) {
  permits_.allow(0, Source::target, now() + 10s);
  permits_.hinder(0, now() + 1s);
  expectFor(1401ms);
}

TEST_F(PermitsTest, OfOthersThanATargetAreNotUsedUpByStanding) {
  for (const Source source : {Source::stream, Source::trajectory, Source::homing}) {
    permits_.allow(0, source, now() + 1s);
    expectFor(1s);
  }
}

TEST_F(PermitsTest, EndWithThePower) {
  permits_.allow(0, Source::stream, now() + 10s);
  permits_.allow(0, Source::target, now() + 10s);
  permits_.allow(0, Source::trajectory, now() + 10s);
  truths_[0].velocity = 1.0;
  truths_[0].power = false;
  wait(2ms);
  EXPECT_FALSE(mayMove());
}

TEST_F(PermitsTest, GivenWithoutPowerStay) {
  truths_[0].power = false;
  wait(1ms);
  permits_.allow(0, Source::stream, now() + 100ms);
  wait(50ms);
  truths_[0].power = true;
  expectFor(50ms);
}

// 1.2 * 1 rad/s / 4 rad/s^2 + 0.15 s.
TEST_F(PermitsTest, EndWithAFaultAfterTheTimeToStop) {
  permits_.allow(0, Source::trajectory, now() + 10s);
  truths_[0].velocity = -1.0;
  truths_[0].statusword = 0x0008;
  wait(1ms);
  expectFor(450ms);
}

TEST_F(PermitsTest, GivenInAFaultStay) {
  truths_[0].statusword = 0x0008;
  wait(1ms);
  permits_.allow(0, Source::stream, now() + 1s);
  expectFor(1s);
}

TEST_F(PermitsTest, OfAHomingOutlastFaultAndPowerAsItEnablesFirst) {
  permits_.allow(0, Source::homing, kNever);
  truths_[0].statusword = 0x0008;
  wait(1ms);
  truths_[0].power = false;
  wait(1s);
  EXPECT_TRUE(mayMove());
  permits_.cut(0, Source::homing, now());
  wait(2ms);
  EXPECT_FALSE(mayMove());
}

TEST_F(PermitsTest, EndWithAnAnswerThatItStands) {
  permits_.allow(0, Source::stream, now() + 10s);
  permits_.allow(0, Source::target, now() + 10s);
  permits_.allow(0, Source::trajectory, now() + 10s);
  permits_.allow(0, Source::homing, kNever);
  wait(100ms);
  permits_.end(0, now() - 10ms, now());
  wait(1ms);
  EXPECT_FALSE(mayMove());
}

TEST_F(PermitsTest, ThatCameInTheCycleOfTheAnswerOutlastIt) {
  permits_.allow(0, Source::stream, now() + 100ms);
  wait(4ms);
  permits_.end(0, now() - 50ms, now());
  expectFor(96ms);
}

TEST_F(PermitsTest, ThatCameACycleBeforeTheAnswerDoNot) {
  permits_.allow(0, Source::stream, now() + 100ms);
  wait(5ms);
  permits_.end(0, now() - 50ms, now());
  wait(1ms);
  EXPECT_FALSE(mayMove());
}

TEST_F(PermitsTest, OfAHomingThatWasCalledLaterOutlastTheAnswer) {
  const Time called = now();
  wait(10ms);
  permits_.allow(0, Source::homing, kNever);
  wait(10ms);
  permits_.end(0, called, now());
  wait(1s);
  EXPECT_TRUE(mayMove());
}

TEST_F(PermitsTest, LastLongerByWhatTheHostStoodStill) {
  permits_.allow(0, Source::trajectory, now() + 100ms);
  permits_.allow(1, Source::target, now() + 10s);
  permits_.delay(500ms, now());
  wait(598ms);
  EXPECT_TRUE(mayMove(0));
  wait(4ms);
  EXPECT_FALSE(mayMove(0));
  wait(290ms);
  EXPECT_TRUE(mayMove(1)) << "nor is a target used up by standing meanwhile";
  wait(20ms);
  EXPECT_FALSE(mayMove(1));
}

TEST_F(PermitsTest, ThatEndedBeforeTheHostStoodStillStayEnded) {
  permits_.allow(0, Source::trajectory, now() + 10ms);
  wait(12ms);
  permits_.delay(500ms, now());
  EXPECT_FALSE(mayMove());
}

TEST_F(PermitsTest, LastHalfASecondLongerWhileFramesAreLost) {
  permits_.allow(0, Source::stream, now() + 100ms);
  permits_.stretch(0, 500ms, now() + 2s);
  expectFor(600ms);
  permits_.allow(0, Source::stream, now() + 100ms);
  expectFor(600ms);
}

TEST_F(PermitsTest, LastNoLongerOnceFramesAreLostNoMore) {
  permits_.allow(0, Source::stream, now() + 100ms);
  permits_.stretch(0, 500ms, now() + 200ms);
  wait(199ms);
  EXPECT_TRUE(mayMove());
  wait(1ms);
  EXPECT_FALSE(mayMove());
}

TEST_F(PermitsTest, WithoutAnEndAreNotStretched) {
  permits_.allow(0, Source::homing, kNever);
  permits_.stretch(0, 500ms, now() + 2s);
  permits_.delay(500ms, now());
  EXPECT_EQ(permits_.until(0), kNever);
}

}  // namespace
}  // namespace cia402::campaign
