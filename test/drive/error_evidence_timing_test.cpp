// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// EMCY, 603Fh and 1001h to the millisecond, and what this program itself has caused.
#include "../../src/drive/error_evidence.h"

#include <algorithm>

#include "canopen/sdo_client_fixture.h"

namespace cia402::drive {
namespace {

using namespace std::chrono_literals;

/// The evidence alone, at node 1, against a scripted server and a clock of milliseconds.
class ErrorEvidenceTiming : public canopen::test::SdoClientFixture {
 protected:
  ErrorEvidenceTiming() {
    code_spec.id = {0x603F, 0};
    code_spec.name = "error_code";
  }
  void emergency(std::uint16_t code, const std::string& excuse = {}) {
    fieldbus::Emergency message;
    message.code = code;
    evidence.onEmergency(message, excuse, now);
  }
  /// A cycle in which the drive shows fault or not, and 603Fh by TPDO if it is given.
  void show(bool faulted, std::optional<std::uint16_t> told = {}) {
    ErrorEvidence::Look look;
    look.faulted = faulted;
    look.told = told;
    evidence.update(look, client, now);
  }
  /// A cycle in which 603Fh can only be read; what was asked before is answered first.
  void showUntold(bool faulted) {
    ErrorEvidence::Look look;
    look.faulted = faulted;
    look.by_sdo = &code_spec;
    run();
    evidence.update(look, client, now);
  }
  /// Lets the client work. @return how often 1001h was asked
  long looks() {
    run();
    const auto sent = peer.take();
    return std::count(sent.begin(), sent.end(), kAskRegister);
  }
  static constexpr char kAskRegister[] = "601 40 01 10 00 00 00 00 00";
  static constexpr char kAskCode[] = "601 40 3F 60 00 00 00 00 00";
  ObjectSpec code_spec;
  ErrorEvidence evidence;
};

TEST_F(ErrorEvidenceTiming, TheErrorRegisterIsReadASecondAfterTheEmergencyAndAfterEachAnswer) {
  peer.on(kAskRegister, "581 4F 01 10 00 01 00 00 00");
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
  peer.replace(kAskRegister, "581 4F 01 10 00 00 00 00 00");
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
  peer.on(kAskRegister, "581 4F 01 10 00 00 00 00 00");
  emergency(0x4210);
  now += 1s;
  show(false);
  ASSERT_EQ(looks(), 1);
  emergency(0x4310);
  show(false);
  EXPECT_EQ(evidence.pending(), 0x4310);
}

TEST_F(ErrorEvidenceTiming, ADriveThatHasNoErrorRegisterIsAskedOnce) {
  peer.on(kAskRegister, "581 80 01 10 00 00 00 02 06");
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
  const char ask_device_type[] =
      "601 40 00 10 00 00 00 00 00";  // the client does before it asks anew
  peer.on(ask_device_type, "581 43 00 10 00 92 01 02 00");
  emergency(0x4210);
  now += 1s;
  show(false);
  ASSERT_EQ(looks(), 1);
  while (!client.idle()) wait(500);
  peer.take();
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
  peer.on(kAskCode, "581 4B 3F 60 00 11 86 00 00");
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
  peer.on(kAskCode, "581 4B 3F 60 00 11 86 00 00").on(kAskCode, "581 4B 3F 60 00 05 73 00 00");
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
    peer.replace(kAskCode, "581 4B 3F 60 00 11 86 00 00")
        .on(kAskCode, "581 4B 3F 60 00 05 73 00 00");
    showUntold(true);  // asks; the answer to that comes with the next cycle
    if (reset) evidence.forget();
    if (!reset) showUntold(false);
    showUntold(true);
    showUntold(true);
    EXPECT_EQ(evidence.code(), 0x7305) << reset;
  }
}

TEST_F(ErrorEvidenceTiming, AResetForgetsTheErrorCodeThatWasRead) {
  peer.on(kAskCode, "581 4B 3F 60 00 11 86 00 00").on(kAskCode, "581 4B 3F 60 00 05 73 00 00");
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
  peer.on(kAskCode, "581 41 3F 60 00 09 00 00 00")
      .on("601 60 00 00 00 00 00 00 00", "581 00 11 86 00 00 00 00 00")
      .on("601 70 00 00 00 00 00 00 00", "581 1B 00 00 00 00 00 00 00");
  showUntold(true);
  showUntold(true);
  ASSERT_TRUE(client.idle());
  ASSERT_EQ(client.counters().completed, 1U);
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
