// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The oracle that compares what the driver shows with what is true finds what it is for.
#include <gtest/gtest.h>

#include <functional>

#include "bus/jobs/procedure_command.h"
#include "oracle_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

/// A driver that runs, and truths that differ from those of its drives as a test wants.
class SnapshotTest : public OracleTest {
 protected:
  SnapshotTest()
      : OracleTest(makeSnapshots,
                   "bus: {interface: can0, bitrate: 1000000, sync_period: 0.004}\naxes:\n"
                   "  a1: {node_id: 1, drive: generic_cia402, counts_per_turn: 4096,\n"
                   "    gear_ratio: 50.0, limits: {lower: -3, upper: 3, velocity: 1,\n"
                   "    acceleration: 4}}\n") {
    stage_.world().powerOn();
    stage_.host().start();
    wait(3s);
    settle();
  }
  /// All is as it seems for long enough to be judged; the next judgement is 10 ms away.
  void settle() {
    differs_ = nullptr;
    lookFor(200ms);
    EXPECT_EQ(found(), "");
    mark();
  }
  void enable() {
    drive::ProcedureRequest request;
    request.kind = drive::ProcedureKind::enable;
    stage_.host().post(bus::Command(bus::ProcedureCommand{"a1", request}));
    lookFor(3s);
    ASSERT_TRUE(truths_[0].enabled());
    settle();
  }
  void look() override {
    wait(1ms);
    stage_.look(truths_);
    if (differs_) differs_(truths_[0]);
    oracle_->look(view());
  }
  void lookAt(std::function<void(AxisTruth&)> differs, Duration duration) {
    differs_ = std::move(differs);
    lookFor(duration);
  }
  static void enabled(AxisTruth& truth) { truth.statusword = 0x0237; }
  static void disabled(AxisTruth& truth) { truth.statusword = 0x0240; }
  static void faulty(AxisTruth& truth) { truth.statusword = 0x0208; }
  static void turns(AxisTruth& truth) { truth.velocity = 0.2; }
  /// The place that the drive tells is three counts of 3.068e-5 rad away; two may be.
  static void shifted(AxisTruth& truth) { truth.told += 9.2e-5; }

  std::function<void(AxisTruth&)> differs_;
};

// What was true in the last 60 ms may be shown; each tenth millisecond is judged.
TEST_F(SnapshotTest, OfADriveThatIsEnabledAndNotShownSoIsFound) {
  lookAt(enabled, 80ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +70 ms");
}

TEST_F(SnapshotTest, OfADriveThatWasEnabledForLessIsNot) {
  lookAt(enabled, 60ms);
  settle();
}

TEST_F(SnapshotTest, OfADriveThatIsShownEnabledAndIsNotIsFound) {
  enable();
  lookAt(disabled, 80ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +70 ms");
}

TEST_F(SnapshotTest, OfADriveThatWasNotEnabledForLessIsNot) {
  enable();
  lookAt(disabled, 60ms);
  settle();
}

TEST_F(SnapshotTest, OfADriveThatIsShownInAFaultAndHasNoneIsFound) {
  ASSERT_TRUE(stage_.world().drive(0).inject("overtemperature", now()));
  lookFor(1s);
  ASSERT_TRUE(truths_[0].faulted());
  settle();
  lookAt(disabled, 80ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +70 ms");
  findings_.clear();
  settle();
  lookAt(disabled, 60ms);
  settle();
}

TEST_F(SnapshotTest, OfADriveThatIsInAFaultAndNotShownSoIsFound) {
  const auto faulted = [](AxisTruth& truth) { truth.statusword = 0x0008; };
  lookAt(faulted, 80ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +70 ms");
  findings_.clear();
  settle();
  lookAt(faulted, 60ms);
  settle();
}

TEST_F(SnapshotTest, MayBeTrueOfADriveFromLookToLookAsItsFrameTells) {
  enable();
  lookAt(disabled, 50ms);
  frame(0x181, {0x37, 0x02, 0, 0, 0, 0, 0, 0});
  lookFor(60ms);
  EXPECT_EQ(found(), "") << "60 ms after the frame";
  lookFor(10ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +120 ms");
}

// 10 % of 1 rad/s, and 5 % of how much it has changed. Smoothed by 25 ms the velocity is beyond
// that after 19 ms: 0.2 (1 - 0.96^19) = 0.108, and has been for all of 60 ms after 78; each 10 ms
// it is judged.
TEST_F(SnapshotTest, OfAnotherSpeedIsFound) {
  lookAt([](AxisTruth& truth) { truth.velocity = 0.2; }, 90ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +80 ms");
}

TEST_F(SnapshotTest, OfAnotherSpeedBackwardsIsFound) {
  lookAt([](AxisTruth& truth) { truth.velocity = -0.2; }, 90ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +80 ms");
}

TEST_F(SnapshotTest, OfASpeedWithinTheBoundIsNot) {
  lookAt([](AxisTruth& truth) { truth.velocity = 0.099; }, 200ms);
  EXPECT_EQ(found(), "");
}

TEST_F(SnapshotTest, OfASpeedThatItHadOfLateIsNot) {
  lookAt(turns, 59ms);
  settle();
}

TEST_F(SnapshotTest, ThatShiftsIsFound) {
  lookAt(shifted, 10ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +10 ms");
}

TEST_F(SnapshotTest, ThatShiftsBackwardsIsFound) {
  lookAt([](AxisTruth& truth) { truth.told -= 9.2e-5; }, 10ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +10 ms");
}

TEST_F(SnapshotTest, ThatShiftsByTwoCountsIsNot) {
  lookAt([](AxisTruth& truth) { truth.told += 6.13e-5; }, 200ms);
  EXPECT_EQ(found(), "");
}

TEST_F(SnapshotTest, MayShiftWhileTheAxisMovesAndNoLongerThan60MsAfter) {
  const auto moves = [](AxisTruth& truth) {
    shifted(truth);
    truth.velocity = 0.01;
  };
  lookAt(moves, 50ms);
  lookAt(shifted, 60ms);
  EXPECT_EQ(found(), "");
  lookFor(10ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +120 ms");
}

TEST_F(SnapshotTest, MayShiftWhileAZeroIsSet) {
  call("set_position", "a1");
  lookFor(200ms);
  lookAt(shifted, 300ms);
  answer("set_position", "a1");
  lookFor(500ms);
  EXPECT_EQ(found(), "") << "the new zero";
  lookAt([](AxisTruth& truth) { truth.told += 2 * 9.2e-5; }, 10ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +1010 ms") << "nobody sets one any more";
}

TEST_F(SnapshotTest, MayNotShiftForCallsThatSetNoZero) {
  for (const char* verb : {"halt", "enable", "disable", "quick_stop", "clear_faults", "read"}) {
    findings_.clear();
    settle();
    call(verb, "a1");
    lookAt(shifted, 10ms);
    EXPECT_EQ(found(), "untrue_snapshot a1 +10 ms") << verb;
    answer(verb, "a1");
  }
}

TEST_F(SnapshotTest, IsNotJudgedWhileFramesMayBeLostNorFor60MsAfter) {
  Time Conditions::*const kinds[] = {&Conditions::lossy, &Conditions::foreign,
                                     &Conditions::host_late};
  for (const auto kind : kinds) {
    findings_.clear();
    settle();
    conditions_.*kind = now() + 101ms;
    lookAt(turns, 159ms);
    EXPECT_EQ(found(), "");
    lookFor(11ms);
    EXPECT_EQ(found(), "untrue_snapshot a1 +160 ms");
  }
}

TEST_F(SnapshotTest, IsNotJudgedWhileTheDriveIsCutOffOrBlockedNorFor60MsAfter) {
  Time Conditions::Axis::*const kinds[] = {&Conditions::Axis::cut_off, &Conditions::Axis::blocked};
  for (const auto kind : kinds) {
    findings_.clear();
    settle();
    conditions_.axes[0].*kind = now() + 101ms;
    lookAt(turns, 159ms);
    EXPECT_EQ(found(), "");
    lookFor(11ms);
    EXPECT_EQ(found(), "untrue_snapshot a1 +160 ms");
  }
}

TEST_F(SnapshotTest, IsNotJudgedOfADriveThatIsNotOperational) {
  const auto stopped = [](AxisTruth& truth) {
    turns(truth);
    truth.nmt = canopen::NmtState::stopped;
  };
  lookAt(stopped, 500ms);
  EXPECT_EQ(found(), "");
}

TEST_F(SnapshotTest, IsNoneWithoutADriver) {
  stage_.host().kill();
  lookAt(turns, 500ms);
  EXPECT_EQ(found(), "");
}

}  // namespace
}  // namespace cia402::campaign
