// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The oracles judge each axis of a drive by what is its own, and the drive by all its axes.
#include <gtest/gtest.h>

#include "dual_robot.h"
#include "oracle_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

class DualTargets : public OracleTest {
 protected:
  DualTargets() : OracleTest(makeTargetSteps, dualRobot()) {
    for (AxisTruth& truth : truths_) truth.mode = 8;
  }
};

// 1.02 * 1 rad/s * 4 ms and two counts are 135 counts of a1, and 214 of a2.
TEST_F(DualTargets, StepByTheMotorOfTheirAxis) {
  for (const std::uint32_t target : {0U, 200U}) {
    lookFor(4ms);
    rpdos(0, {{0x6840, 0x000F}, {0x687A, target}});
    rpdos(1, {{0x6040, 0x000F}, {0x607A, target}});
  }
  EXPECT_EQ(allFound(), "target_step a1 +8 ms");
}

class DualAnswers : public OracleTest {
 protected:
  DualAnswers() : OracleTest(makeAnswers, dualRobot()) {}
  /// The drive tells that an axis is enabled.
  void tellsEnabled(std::size_t axis) {
    const PdoPlace& place = *stage_.statusword(axis);
    can::Frame frame(place.cob_id, {0, 0, 0, 0, 0, 0, 0, 0});
    frame.data[place.byte] = 0x37;
    oracle_->onFrame(frame, view());
  }
};

TEST_F(DualAnswers, AreTrueOfTheAxisWhoseStatuswordToldSo) {
  truths_[0].power = truths_[1].power = false;
  lookFor(100ms);
  tellsEnabled(1);
  answer("enable", "a2");
  EXPECT_EQ(found(), "");
  answer("enable", "a1");
  EXPECT_EQ(found(), "untrue_answer a1 +100 ms");
  findings_.clear();
  tellsEnabled(0);
  answer("enable", "a1");
  EXPECT_EQ(found(), "");
}

class DualRequests : public OracleTest {
 protected:
  DualRequests() : OracleTest(makeVainRequests, dualRobot()) {}
};

TEST_F(DualRequests, ThatAreVainAreFoundOnce) {
  for (int i = 0; i < 3; ++i) frame(0x704, {0x04});
  for (int i = 0; i < 2; ++i) frame(0x604, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(allFound(), "vain_request a1 +0 ms");
}

class DualSnapshots : public OracleTest {
 protected:
  DualSnapshots() : OracleTest(makeSnapshots, dualRobot()) {
    stage_.world().powerOn();
    stage_.host().start();
    wait(3s);
    lookFor(200ms);
    mark();
  }
  /// a1 is told away from where it is shown, or is in a fault.
  void look() override {
    wait(1ms);
    stage_.look(truths_);
    truths_[0].told += shift_;
    if (faulted_) truths_[0].statusword = 0x0008;
    oracle_->look(view());
  }
  /// The drive tells that an axis is well, and disabled.
  void tellsSound(std::size_t axis) {
    const PdoPlace& place = *stage_.statusword(axis);
    can::Frame frame(place.cob_id, {0, 0, 0, 0, 0, 0, 0, 0});
    frame.data[place.byte] = 0x40;
    oracle_->onFrame(frame, view());
  }

  double shift_ = 0.0;  ///< 9.2e-5 rad are three counts, two may be
  bool faulted_ = false;
};

TEST_F(DualSnapshots, MayBeTrueAsTheStatuswordOfTheirAxisTells) {
  faulted_ = true;
  lookFor(50ms);
  tellsSound(0);
  lookFor(60ms);
  EXPECT_EQ(found(), "") << "60 ms after the frame";
  tellsSound(1);
  lookFor(10ms);
  EXPECT_EQ(found(), "untrue_snapshot a1 +120 ms") << "the frame was about a2";
}

TEST_F(DualSnapshots, MayShiftWhereTheDriveIsGivenAnotherZero) {
  for (const char* verb : {"recover", "save", "restore", "nmt"}) {
    call(verb, "a2");
    shift_ += 9.2e-5;
    lookFor(100ms);
    answer(verb, "a2");
    lookFor(200ms);
    EXPECT_EQ(found(), "") << verb;
  }
}

TEST_F(DualSnapshots, MayNotShiftWhereTheOtherAxisIs) {
  for (const char* verb : {"set_position", "home"}) {
    shift_ = 0.0;
    lookFor(200ms);
    findings_.clear();
    mark();
    call(verb, "a2");
    shift_ = 9.2e-5;
    lookFor(10ms);
    answer(verb, "a2");
    EXPECT_EQ(found(), "untrue_snapshot a1 +10 ms") << verb;
  }
}

class TakenDriveTest : public OracleTest {
 protected:
  TakenDriveTest() : OracleTest(makeTakenDrives, dualRobot()) { settle(); }
  /// All are operational and under power, and nothing was found.
  void settle() {
    for (AxisTruth& truth : truths_) {
      truth.power = true;
      truth.nmt = canopen::NmtState::operational;
    }
    look();
    findings_.clear();
    mark();
  }
  /// The drive of a1 and a2 is in another state.
  void leaves(canopen::NmtState state) {
    truths_[0].nmt = truths_[1].nmt = state;
    look();
  }
};

TEST_F(TakenDriveTest, IsFoundWhileOneOfItsMotorsHasPower) {
  truths_[0].power = false;
  look();
  mark();
  leaves(canopen::NmtState::stopped);
  EXPECT_EQ(allFound(), "drive_taken a2 +1 ms");
}

TEST_F(TakenDriveTest, IsFoundWhateverThePowerDoesThen) {
  truths_[0].power = truths_[1].power = false;
  leaves(canopen::NmtState::boot_up);
  EXPECT_EQ(allFound(), "drive_taken a2 +1 ms");
}

TEST_F(TakenDriveTest, WithoutPowerIsNone) {
  truths_[0].power = truths_[1].power = false;
  look();
  leaves(canopen::NmtState::pre_operational);
  EXPECT_EQ(found(), "");
}

TEST_F(TakenDriveTest, IsFoundOnce) {
  leaves(canopen::NmtState::stopped);
  lookFor(50ms);
  EXPECT_EQ(allFound(), "drive_taken a2 +1 ms");
}

TEST_F(TakenDriveTest, IsNoneWhileTheWorldIsDisturbed) {
  Time Conditions::Axis::*const kinds[] = {&Conditions::Axis::may_coast, &Conditions::Axis::unheard,
                                           &Conditions::Axis::cut_off, &Conditions::Axis::blocked};
  for (const auto kind : kinds) {
    settle();
    conditions_.axes[1].*kind = now() + 10ms;
    leaves(canopen::NmtState::stopped);
    EXPECT_EQ(found(), "");
    conditions_.axes[1].*kind = Time();
  }
  settle();
  conditions_.ended = now() + 10ms;
  leaves(canopen::NmtState::stopped);
  EXPECT_EQ(found(), "") << "the driver ends";
}

// Its life time is three times 0.1 s.
TEST_F(TakenDriveTest, MayHaveLostAnAnswerToGuardingBefore) {
  conditions_.lossy = now() - 250ms;
  leaves(canopen::NmtState::stopped);
  EXPECT_EQ(allFound(), "drive_taken a2 +1 ms") << "heartbeats do not alternate";
}

class TakenGuardedDriveTest : public OracleTest {
 protected:
  TakenGuardedDriveTest() : OracleTest(makeTakenDrives, guarded()) {}
  static std::string guarded() {
    std::string robot = kJudgedRobot;
    const std::string drive = "drive: generic_cia402";
    return robot.replace(robot.find(drive), drive.size(), drive + ", error_control: guarding");
  }
  /// So long after the last frame that may have been lost.
  std::string foundAfter(Duration lost) {
    truths_[0].power = true;
    truths_[0].nmt = canopen::NmtState::operational;
    look();
    findings_.clear();
    conditions_.lossy = now() - lost;
    mark();
    truths_[0].nmt = canopen::NmtState::stopped;
    look();
    return allFound();
  }
};

TEST_F(TakenGuardedDriveTest, MayHaveLostAnAnswerBefore) {
  EXPECT_EQ(foundAfter(250ms), "");
  EXPECT_EQ(foundAfter(310ms), "drive_taken a1 +1 ms");
}

}  // namespace
}  // namespace cia402::campaign
