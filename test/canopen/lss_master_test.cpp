// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/lss/master.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/lss/task.h"
#include "canopen/scripted_peer.h"

namespace cia402::canopen {
namespace {

using namespace std::chrono_literals;
using test::frame;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kAskSerial = "7E5 5D 00 00 00 00 00 00 00";
constexpr const char* kSerial = "7E4 5D 39 30 00 00 00 00 00";
constexpr const char* kOtherSerial = "7E4 5D 3A 30 00 00 00 00 00";

class LssMasterTest : public testing::Test {
 protected:
  void hear(const char* line) { master.receive(frame(line), now); }
  void pass(Duration duration) {
    now += duration;
    master.tick(now);
  }
  test::ScriptedPeer wire;
  LssMaster master{wire};
  Time now{};
};

TEST_F(LssMasterTest, AnAnswerIsTakenOnceNobodyElseAnswers) {
  master.begin(lssInquireRequest(3), now);
  EXPECT_THAT(wire.take(), ElementsAre(kAskSerial));
  pass(5ms);
  hear(kSerial);
  pass(19ms);
  EXPECT_TRUE(master.busy()) << "another device may answer still";
  pass(1ms);
  ASSERT_TRUE(master.ok());
  EXPECT_EQ(lss::numberOf(master.answers().front()), 12345u);
  EXPECT_EQ(master.nextDeadline(), kNever);
}

TEST_F(LssMasterTest, ARequestThatNobodyAnswersIsRepeatedAndThenGivenUpInWords) {
  master.begin(lssInquireRequest(3), now);
  for (int i = 0; i < 4; ++i) {
    pass(99ms);
    EXPECT_EQ(wire.sent.size(), i + 1u);
    pass(1ms);
    EXPECT_EQ(wire.sent.size(), i + 2u);
  }
  pass(100ms);
  EXPECT_FALSE(master.busy());
  EXPECT_FALSE(master.ok());
  EXPECT_TRUE(master.silent());
  EXPECT_EQ(master.problem(), "nobody answered within 0.1 s, asked 5 times");
}

TEST_F(LssMasterTest, ALostAnswerIsMadeUpForByTheRepetition) {
  master.begin(lssInquireRequest(3), now);
  pass(100ms);
  hear(kSerial);
  pass(20ms);
  EXPECT_TRUE(master.ok());
  EXPECT_THAT(wire.take(), ElementsAre(kAskSerial, kAskSerial));
}

TEST_F(LssMasterTest, TwoDifferentAnswersAreNeverTaken) {
  master.begin(lssInquireRequest(3), now);
  for (int i = 0; i < 5; ++i) {
    hear(kSerial);
    pass(10ms);
    hear(kOtherSerial);
    pass(20ms);
  }
  ASSERT_FALSE(master.busy());
  EXPECT_FALSE(master.ok());
  EXPECT_FALSE(master.silent());
  EXPECT_EQ(master.problem(),
            "2 answers came where one device was asked (5D 39 30 00 00 00 00 00 and "
            "5D 3A 30 00 00 00 00 00), asked 5 times");
}

TEST_F(LssMasterTest, ADuplicateIsAskedAboutAgain) {
  master.begin(lssInquireRequest(3), now);
  hear(kSerial);
  hear(kSerial);
  pass(20ms);
  EXPECT_TRUE(master.busy());
  hear(kSerial);
  pass(20ms);
  EXPECT_TRUE(master.ok());
  EXPECT_EQ(wire.sent.size(), 2u);
}

TEST_F(LssMasterTest, OtherFramesAreNoAnswers) {
  hear(kSerial);  // to nothing
  master.begin(lssInquireRequest(3), now);
  hear("7E4 5C 02 00 01 00 00 00 00");  // late answer to another inquiry
  hear("7E4 5D 39 30");                 // too short for CiA 305
  hear("7E5 5D 39 30 00 00 00 00 00");  // another master's request
  can::Frame remote = frame(kSerial);
  remote.remote = true;
  master.receive(remote, now);
  EXPECT_EQ(master.strayAnswers(), 3u);
  for (int i = 0; i < 5; ++i) pass(100ms);
  EXPECT_TRUE(master.silent());
}

TEST_F(LssMasterTest, AnUnconfirmedRequestEndsByItself) {
  master.begin(lssWaitingRequest(), now);
  EXPECT_THAT(wire.take(), ElementsAre("7E5 04 00 00 00 00 00 00 00", "7E5 04 00 00 00 00 00 00 00",
                                       "7E5 04 00 00 00 00 00 00 00"));
  pass(20ms);
  EXPECT_TRUE(master.ok());
}

TEST_F(LssMasterTest, AQuestionOfFastscanWaitsForItsWindowEvenIfAnswered) {
  LssRequest request;
  request.frames = {lss::fastscan(0, lss::kFastscanStart, 0, 0)};
  request.answer = lss::Command::identified;
  request.question = true;
  master.begin(request, now);
  pass(1ms);
  hear("7E4 4F 00 00 00 00 00 00 00");
  pass(18ms);
  EXPECT_TRUE(master.busy());
  hear("7E4 4F 00 00 00 00 00 00 00");  // a second device is slower
  pass(1ms);
  EXPECT_TRUE(master.ok());
  EXPECT_FALSE(master.silent());
  EXPECT_EQ(master.answers().size(), 2u);
}

TEST_F(LssMasterTest, ABabblingDeviceDoesNotFillTheMemory) {
  master.begin(lssInquireRequest(3), now);
  for (int i = 0; i < 1000; ++i) hear(kSerial);
  EXPECT_EQ(master.answers().size(), 256u);
}

TEST_F(LssMasterTest, ARequestMayHaveFewerAttempts) {
  LssRequest request = lssInquireRequest(3);
  request.attempts = 2;
  master.begin(request, now);
  pass(100ms);
  EXPECT_TRUE(master.busy());
  pass(100ms);
  EXPECT_EQ(master.problem(), "nobody answered within 0.1 s, asked 2 times");
  EXPECT_EQ(wire.sent.size(), 2u);
}

}  // namespace
}  // namespace cia402::canopen
