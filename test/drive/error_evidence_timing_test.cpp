// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// EMCY, 603Fh and 1001h to the millisecond, and what this program itself has caused.
#include "drive/axis/error_evidence.h"

#include "drive/objects_fixture.h"

namespace cia402::drive {
namespace {

using namespace std::chrono_literals;

using test::FakeDrive;

const FakeDrive::Key kRegister{0x1001, 0}, kCode{0x603F, 0};

/// The evidence alone, against a drive that is asked for objects and a clock of milliseconds.
class ErrorEvidenceTiming : public test::ObjectsFixture {
 protected:
  ErrorEvidenceTiming() {
    code_spec.id = {0x603F, 0};
    code_spec.name = "error_code";
    drive.unanswered_reads = {kRegister};  // where the test does not say what it is
  }
  void emergency(std::uint16_t code, const std::string& excuse = {}) {
    fieldbus::Emergency message;
    message.code = code;
    evidence.onEmergency(message, excuse, false, now);
  }
  /// A cycle in which the drive shows fault or not, and tells 603Fh if that is given.
  void show(bool faulted, std::optional<std::uint16_t> told = {}) {
    ErrorEvidence::Look look;
    look.faulted = faulted;
    look.told = told;
    evidence.update(look, objects, now);
  }
  /// A cycle in which 603Fh can only be read; what was asked before is answered first.
  void showUntold(bool faulted) {
    ErrorEvidence::Look look;
    look.faulted = faulted;
    look.asked = &code_spec;
    run();
    evidence.update(look, objects, now);
  }
  /// The error register holds `value` from now on.
  void setRegister(std::uint8_t value) {
    drive.dictionary[kRegister] = {value, 1};
    drive.unanswered_reads.clear();
  }
  /// Has the drive asked. @return how often for 1001h
  int looks() {
    drive.reads.clear();
    run();
    return drive.reads[kRegister];
  }
  ObjectSpec code_spec;
  ErrorEvidence evidence;
};

TEST_F(ErrorEvidenceTiming, TheErrorRegisterIsReadASecondAfterTheEmergencyAndAfterEachAnswer) {
  setRegister(1);
  show(false);
  emergency(0x4210);
  now += 999ms;
  show(false);
  EXPECT_EQ(looks(), 0);
  now += 1ms;
  show(false);
  EXPECT_EQ(looks(), 1);
  show(false);  // the answer: the error stands
  now += 999ms;
  show(false);
  EXPECT_EQ(looks(), 0);
  setRegister(0);
  now += 1ms;
  show(false);
  EXPECT_EQ(looks(), 1);
  EXPECT_EQ(evidence.pending(), 0x4210);
  show(false);
  EXPECT_EQ(evidence.pending(), 0) << "1001h is 0";
}

TEST_F(ErrorEvidenceTiming, EachEmergencyPutsOffTheLookAtTheErrorRegister) {
  emergency(0x4210);
  now += 900ms;
  emergency(0x4310);
  now += 999ms;
  show(false);
  EXPECT_EQ(looks(), 0);
  now += 1ms;
  show(false);
  EXPECT_EQ(looks(), 1);
}

TEST_F(ErrorEvidenceTiming, AnAnswerFromBeforeTheEmergencyDoesNotEndIt) {
  setRegister(0);
  emergency(0x4210);
  now += 1s;
  show(false);
  ASSERT_EQ(looks(), 1);
  emergency(0x4310);
  show(false);
  EXPECT_EQ(evidence.pending(), 0x4310);
}

TEST_F(ErrorEvidenceTiming, ADriveThatHasNoErrorRegisterIsAskedOnce) {
  drive.unanswered_reads.clear();
  drive.read_aborts[kRegister] = 0x06020000;
  emergency(0x4210);
  long asked = 0;
  for (int i = 0; i < 30; ++i) {
    now += 1s;
    show(false);
    asked += looks();
  }
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(evidence.pending(), 0x4210);
}

TEST_F(ErrorEvidenceTiming, ADriveThatDidNotAnswerIsAskedAgainAfterTenSeconds) {
  emergency(0x4210);
  now += 1s;
  show(false);
  ASSERT_EQ(looks(), 1);
  while (!objects.idle()) wait(500ms);
  show(false);
  now += 9999ms;
  show(false);
  EXPECT_EQ(looks(), 0);
  now += 1ms;
  show(false);
  EXPECT_EQ(looks(), 1);
}

TEST_F(ErrorEvidenceTiming, AnExcuseIsForItsCodeUntilTheDriveSendsThatOnItsOwn) {
  const std::uint16_t at_first[] = {0x0000, 0x0001, 0x8130};
  for (const std::uint16_t none : at_first) {
    EXPECT_EQ(evidence.excuse(none), nullptr) << none;
  }
  emergency(0x8130, "its heartbeat was stopped");
  ASSERT_NE(evidence.excuse(0x8130), nullptr);
  EXPECT_EQ(*evidence.excuse(0x8130), "its heartbeat was stopped");
  const std::uint16_t others[] = {0x0000, 0x0001, 0x8611};
  for (const std::uint16_t other : others) {
    EXPECT_EQ(evidence.excuse(other), nullptr) << other;
  }
  emergency(0x8611);
  EXPECT_NE(evidence.excuse(0x8130), nullptr) << "another error excuses nothing and ends nothing";
  emergency(0x8130);
  for (const std::uint16_t none : at_first) {
    EXPECT_EQ(evidence.excuse(none), nullptr) << none;
  }
}

TEST_F(ErrorEvidenceTiming, TheErrorCodeNamesTheFaultUpToHalfASecondAfterIt) {
  for (const auto& [after, code] : {std::make_pair(500ms, 0x8611), std::make_pair(501ms, 0x4210)}) {
    evidence = ErrorEvidence();
    now += 10s;
    show(false, 0);
    emergency(0x4210);
    show(true, 0);
    now += after;
    show(true, 0x8611);
    EXPECT_EQ(evidence.code(), code) << after.count();
  }
}

TEST_F(ErrorEvidenceTiming, AnEmergencyNamesTheFaultUpToHalfASecondAfterIt) {
  for (const auto& [after, code] : {std::make_pair(500ms, 0x8611), std::make_pair(501ms, 0x4210)}) {
    evidence = ErrorEvidence();
    now += 10s;
    show(false, 0);
    show(true, 0x4210);
    now += after;
    emergency(0x8611);
    show(true, 0x4210);
    EXPECT_EQ(evidence.code(), code) << after.count();
  }
}

TEST_F(ErrorEvidenceTiming, AnEmergencyNamesTheFaultThatComesUpToATenthOfASecondLater) {
  drive.dictionary[kCode] = {0x8611, 2};
  for (const auto& [before, code] :
       {std::make_pair(100ms, 0x4210), std::make_pair(101ms, 0x8611)}) {
    evidence = ErrorEvidence();
    now += 10s;
    showUntold(false);
    emergency(0x4210);
    now += before;
    showUntold(true);
    showUntold(true);
    EXPECT_EQ(evidence.code(), code) << before.count();
  }
}

TEST_F(ErrorEvidenceTiming, WhereNothingCameWithAFaultTheLastEmergencyNamesIt) {
  show(false, 0);
  emergency(0x4210);
  now += 5s;
  show(true, 0);
  EXPECT_EQ(evidence.code(), 0x4210);
}

TEST_F(ErrorEvidenceTiming, TheErrorCodeIsReadAnewForAFaultThatFollowsOneThatWentByItself) {
  drive.next_reads[kCode] = {0x8611, 0x7305};
  showUntold(true);
  showUntold(true);
  EXPECT_EQ(evidence.code(), 0x8611);
  showUntold(false);
  showUntold(true);
  EXPECT_EQ(evidence.code(), 0) << "not known yet";
  showUntold(true);
  EXPECT_EQ(evidence.code(), 0x7305);
}

TEST_F(ErrorEvidenceTiming, AnAnswerAboutAFaultThatIsOverDoesNotNameTheNextOne) {
  for (const bool reset : {false, true}) {
    evidence = ErrorEvidence();
    drive.next_reads[kCode] = {0x8611, 0x7305};
    showUntold(true);  // asks; the answer to that comes with the next cycle
    if (reset) evidence.forget();
    if (!reset) showUntold(false);
    showUntold(true);
    showUntold(true);
    EXPECT_EQ(evidence.code(), 0x7305) << reset;
  }
}

TEST_F(ErrorEvidenceTiming, AResetForgetsTheErrorCodeThatWasRead) {
  drive.next_reads[kCode] = {0x8611, 0x7305};
  showUntold(true);
  showUntold(true);
  ASSERT_EQ(evidence.code(), 0x8611);
  evidence.forget();
  EXPECT_EQ(evidence.code(), 0);
  showUntold(true);
  showUntold(true);
  EXPECT_EQ(evidence.code(), 0x7305);
}

TEST_F(ErrorEvidenceTiming, AnErrorCodeOfMoreThanEightBytesIsNone) {
  drive.dictionary[kCode] = {0x8611, 9};
  showUntold(true);
  showUntold(true);
  ASSERT_TRUE(objects.idle());
  ASSERT_EQ(objects.completed(), 1U);
  EXPECT_EQ(evidence.code(), 0);
}

TEST_F(ErrorEvidenceTiming, KnowsTheErrorCodeThatWasToldLast) {
  EXPECT_FALSE(evidence.knows(0));
  show(false, 0x8611);
  EXPECT_TRUE(evidence.knows(0x8611));
  EXPECT_FALSE(evidence.knows(0));
  show(false, 0);
  EXPECT_TRUE(evidence.knows(0));
  EXPECT_FALSE(evidence.knows(0x8611));
}

TEST_F(ErrorEvidenceTiming, IsQuietWithoutFaultAndEmergencyOnly) {
  EXPECT_TRUE(evidence.quiet());
  emergency(0x4210);
  EXPECT_FALSE(evidence.quiet());
  show(false);
  EXPECT_FALSE(evidence.quiet());
  emergency(0);
  show(false);
  EXPECT_TRUE(evidence.quiet());
  show(true);
  EXPECT_FALSE(evidence.quiet()) << "a fault without a code";
  evidence.forget();
  show(false);
  EXPECT_TRUE(evidence.quiet());
}

TEST_F(ErrorEvidenceTiming, WhatWasToldBeforeAResetDoesNotNameTheFaultRightAfterIt) {
  show(false, 0);
  show(true, 0x8611);
  ASSERT_EQ(evidence.code(), 0x8611);
  evidence.forget();
  emergency(0x7305);
  show(false, 0x8611);
  show(true, 0x8611);
  EXPECT_EQ(evidence.code(), 0x7305);
}

}  // namespace
}  // namespace cia402::drive
