// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The oracle of the limits of velocity and acceleration, with its bounds from docs/campaign.md and
// every excuse that it accepts: while the excuse lasts, and no longer.
#include <gtest/gtest.h>

#include "oracle_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

// 1.1 times 1 rad/s.
constexpr double kTooFast = 1.11, kFastEnough = 1.09;
// (2.6 * 4 rad/s^2 + 0.05 * 1 rad/s / 20 ms) * 20 ms = 0.258 rad/s in 20 ms.
constexpr double kTooHard = 0.26, kHardEnough = 0.25;
// For what an excuse leaves behind: a set-point, a window of acceleration.
constexpr Duration kAfterwards = 60ms;

class MotorLimitsTest : public OracleTest {
 protected:
  MotorLimitsTest() : OracleTest(makeMotorLimits) {
    for (AxisTruth& truth : truths_) truth.mode = 8;
    truths_[2].mode = 1;
    lookFor(200ms);
    mark();
  }
  /// Set-points and SYNC each fourth millisecond.
  void look() override {
    wait(1ms);
    if (++looks_ % 4 == 0) cycle();
    oracle_->look(view());
  }
  void cycle() {
    if (feeds_) {
      for (std::size_t i = 0; i < 3; ++i) rpdos(i, {{0x607A, 0U}});
      rpdos(0, {{0x6071, 0U}});
    }
    if (syncs_) frame(0x80, {});
  }
  void turn(double speed, Duration duration, std::size_t axis = 0) {
    truths_[axis].velocity = speed;
    lookFor(duration);
  }
  /// Two speeds that follow each other at once; 30 ms of each.
  void step(double by, std::size_t axis = 0) {
    lookFor(30ms);
    turn(truths_[axis].velocity + by, 30ms, axis);
  }
  /// So long it turns too fast, and is excused; it is found before so long afterwards.
  void excusedFor(Duration duration, Duration afterwards = kAfterwards) {
    turn(1.5, duration);
    EXPECT_EQ(found(), "");
    lookFor(afterwards);
    EXPECT_GT(foundAfter(), duration);
    EXPECT_LE(foundAfter(), duration + afterwards);
  }

  /// A SYNC 3.84 ms after the last: 0.04 of the distance are missing.
  void earlySync() {
    while (looks_ % 4 != 0) look();
    lookFor(3ms);
    wait(840us);
    cycle();
    wait(160us);
    looks_ = 0;
    mark();
    oracle_->look(view());
  }

  int looks_ = 0;
  bool feeds_ = true, syncs_ = true;
};

TEST_F(MotorLimitsTest, FindTooFastAMotor) {
  for (double speed = 0.2; speed < 1.1; speed += 0.2) turn(speed, 40ms);
  turn(kTooFast, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +201 ms");
}

// No RPDO holds a target of that mode: it lacks none.
TEST_F(MotorLimitsTest, FindTooFastAMotorThatHomes) {
  truths_[0].mode = 6;
  lookFor(200ms);
  mark();
  for (double speed = 0.2; speed < 1.1; speed += 0.2) turn(speed, 40ms);
  turn(kTooFast, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +201 ms");
}

TEST_F(MotorLimitsTest, FindTooFastAMotorBackwards) {
  for (double speed = -0.2; speed > -1.1; speed -= 0.2) turn(speed, 40ms);
  turn(-kTooFast, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +201 ms");
}

TEST_F(MotorLimitsTest, LetAMotorTurnAsFastAsItMay) {
  for (double speed = 0.2; speed < 1.1; speed += 0.2) turn(speed, 40ms);
  turn(kFastEnough, 100ms);
  EXPECT_EQ(found(), "");
}

TEST_F(MotorLimitsTest, FindTooHardAnAcceleration) {
  turn(kTooHard, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +1 ms");
}

TEST_F(MotorLimitsTest, FindTooHardABraking) {
  turn(kHardEnough, 50ms);
  turn(0.5, 50ms);
  mark();
  turn(0.5 - kTooHard, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +1 ms");
}

TEST_F(MotorLimitsTest, LetAMotorSpeedUpAsHardAsItMay) {
  turn(kHardEnough, 50ms);
  turn(0.0, 50ms);
  turn(-kHardEnough, 50ms);
  EXPECT_EQ(found(), "");
}

TEST_F(MotorLimitsTest, MeasureAccelerationOver20Ms) {
  for (int i = 1; i <= 19; ++i) turn(0.0137 * i, 1ms);  // 13.7 rad/s^2: 0.274 rad/s in 20 ms
  EXPECT_EQ(found(), "motor_limits a1 +19 ms") << "0.2603 rad/s";
}

TEST_F(MotorLimitsTest, DoNotJudgeWithoutPower) {
  truths_[0].power = false;
  turn(1.5, 100ms);
  EXPECT_EQ(found(), "");
  truths_[0].power = true;
  lookFor(kAfterwards);
  EXPECT_NE(found(), "");
}

TEST_F(MotorLimitsTest, DoNotJudgeAnAxisWithoutThem) {
  turn(100.0, 100ms, 1);
  EXPECT_EQ(found(), "");
}

TEST_F(MotorLimitsTest, DoNotJudgeWhileFramesAreLost) {
  conditions_.lossy = now() + 100ms;
  excusedFor(100ms);
}

TEST_F(MotorLimitsTest, DoNotJudgeWhileAStrangerSends) {
  conditions_.foreign = now() + 100ms;
  excusedFor(100ms);
}

TEST_F(MotorLimitsTest, DoNotJudgeWhileTheLinkIsCut) {
  conditions_.axes[0].cut_off = now() + 100ms;
  excusedFor(100ms);
}

TEST_F(MotorLimitsTest, DoNotJudgeABlockedRotor) {
  conditions_.axes[0].blocked = now() + 100ms;
  excusedFor(100ms);
}

TEST_F(MotorLimitsTest, AreNotExcusedByTheTroubleOfAnotherAxis) {
  conditions_.axes[1].cut_off = conditions_.axes[2].blocked = now() + 1s;
  turn(kTooFast, 1ms);
  EXPECT_EQ(found().substr(0, 15), "motor_limits a1");
}

TEST_F(MotorLimitsTest, AreNotExcusedByALateHostAlone) {
  conditions_.host_late = now() + 1s;
  turn(kTooFast, 1ms);
  EXPECT_EQ(found().substr(0, 15), "motor_limits a1");
}

// The lack shows with the SYNC at its end.
TEST_F(MotorLimitsTest, DoNotJudgeUntil30MsAfterACycleWithoutASetPoint) {
  feeds_ = false;
  lookFor(4ms);
  feeds_ = true;
  mark();
  excusedFor(30ms);
}

TEST_F(MotorLimitsTest, DoNotJudgeUntil30MsAfterALackOfSyncs) {
  syncs_ = false;
  lookFor(6ms);  // 1.5 periods
  syncs_ = true;
  mark();
  excusedFor(30ms);
}

TEST_F(MotorLimitsTest, AreNotExcusedByASetPointThatAnotherDriveLacked) {
  feeds_ = false;
  lookFor(3ms);
  rpdos(0, {{0x607A, 0U}});
  look();
  feeds_ = true;
  mark();
  turn(kTooFast, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +1 ms");
}

TEST_F(MotorLimitsTest, DoNotJudgeADriveThatMakesGoodALackWithHalfOfItsEffortForHalfASecond) {
  feeds_ = false;
  lookFor(4ms);
  feeds_ = true;
  mark();
  truths_[0].effort = -5.1;  // of 10 N m
  excusedFor(500ms);
}

TEST_F(MotorLimitsTest, JudgeADriveThatMakesGoodALackWithLessThanHalfOfItsEffort) {
  feeds_ = false;
  lookFor(4ms);
  feeds_ = true;
  mark();
  truths_[0].effort = 4.9;
  excusedFor(30ms);
}

TEST_F(MotorLimitsTest, AreNotExcusedByEffortWithoutALack) {
  truths_[0].effort = 9.9;
  turn(kTooFast, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +1 ms");
}

TEST_F(MotorLimitsTest, DoNotJudgeTheAccelerationOfADamiaoThatLostSetPointsUntilItRested) {
  conditions_.axes[2].cut_off = now() + 20ms;
  turn(0.5, 300ms, 2);
  step(kTooHard, 2);
  EXPECT_EQ(found(), "");
  turn(0.03, 1ms, 2);
  turn(0.0, 50ms, 2);
  mark();
  turn(kTooHard, 1ms, 2);
  EXPECT_EQ(found(), "motor_limits a3 +1 ms");
}

TEST_F(MotorLimitsTest, JudgeTheVelocityOfADamiaoThatLostSetPoints) {
  conditions_.axes[2].cut_off = now() + 20ms;
  turn(0.5, 300ms, 2);
  mark();
  turn(kTooFast, 1ms, 2);
  EXPECT_EQ(found(), "motor_limits a3 +1 ms");
}

TEST_F(MotorLimitsTest, JudgeTheAccelerationOfAnotherDriveThatLostSetPoints) {
  conditions_.axes[0].cut_off = now() + 20ms;
  turn(0.5, 300ms);
  mark();
  turn(0.5 + kTooHard, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +1 ms");
}

TEST_F(MotorLimitsTest, DoNotJudgeTheAccelerationAtALimitSwitch) {
  turn(0.2, 50ms);
  truths_[0].statusword |= 0x0800;
  lookFor(250ms);
  step(kTooHard);
  EXPECT_EQ(found(), "");
  mark();
  turn(kTooFast, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +1 ms") << "its velocity is limited there";
}

TEST_F(MotorLimitsTest, DoNotJudgeUntil60MsAfterALimitSwitchLetsGo) {
  turn(0.2, 50ms);
  truths_[0].statusword |= 0x0800;
  lookFor(300ms);
  truths_[0].statusword = 0x0027;
  look();
  mark();
  excusedFor(59ms);
}

TEST_F(MotorLimitsTest, DoNotJudgeTheFirst200MsAtALimitSwitch) {
  turn(0.2, 50ms);
  truths_[0].statusword |= 0x0800;
  look();
  mark();
  excusedFor(199ms);
}

TEST_F(MotorLimitsTest, DoNotJudgeTheAccelerationOfACommandedEffort) {
  truths_[0].mode = 10;
  lookFor(100ms);
  mark();
  step(1.0);
  EXPECT_EQ(found(), "");
  turn(kTooFast, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +61 ms") << "its velocity is limited";
}

TEST_F(MotorLimitsTest, DoNotJudgeTheAccelerationInTheTwoCyclesAfterAnEffort) {
  const auto stepsAfterAnEffort = [&](Duration after, double speed) {
    truths_[0].mode = 10;
    lookFor(100ms);
    truths_[0].mode = 8;
    lookFor(after);
    turn(speed, 60ms);
    return found();
  };
  EXPECT_EQ(stepsAfterAnEffort(7ms, 1.0), "");
  EXPECT_NE(stepsAfterAnEffort(10ms, 0.0), "") << "from the third cycle on";
}

TEST_F(MotorLimitsTest, LetAMotorTurnFasterByTheShareThatIsMissingBetweenTwoSyncs) {
  for (double speed = 0.2; speed < 1.1; speed += 0.2) turn(speed, 40ms);
  earlySync();
  turn(1.135, 29ms);
  EXPECT_EQ(found(), "");
  look();
  EXPECT_EQ(found(), "motor_limits a1 +30 ms");
  turn(1.0, 100ms);
  findings_.clear();
  earlySync();
  turn(1.145, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +1 ms") << "0.04, and no more";
}

TEST_F(MotorLimitsTest, DoNotJudgeTheAccelerationFor30MsAfterSyncsThatFollowTooQuickly) {
  earlySync();
  turn(kTooHard, 20ms);
  EXPECT_EQ(found(), "");
  turn(0.0, 100ms);
  findings_.clear();
  earlySync();
  lookFor(30ms);
  turn(kTooHard, 1ms);
  EXPECT_EQ(found(), "motor_limits a1 +31 ms");
}

}  // namespace
}  // namespace cia402::campaign
