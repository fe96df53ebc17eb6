// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/pacer.h"

#include <gtest/gtest.h>

namespace cia402::can {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

struct CountingSink : Sink {
  int frames = 0;
  bool full = false;
  bool send(const Frame&) override {
    if (full) return false;
    ++frames;
    return true;
  }
};

// One bit takes a microsecond. This frame has at most 135 bits; sent in bulk it is taken for those
// that it has.
class PacerTest : public testing::Test {
 protected:
  Time at(int us) const { return Time() + milliseconds(10) + microseconds(us); }
  PacerTest() { pacer.setTime(at(0)); }

  CountingSink sink;
  Pacer pacer{sink, 1e6};
  const Frame frame{0x601, {0, 0, 0, 0, 0, 0, 0, 0}};
};

TEST_F(PacerTest, LetsFourFramesAheadThenWaitsUntilTwoAreLeft) {
  for (int i = 0; i < 4; ++i) {
    ASSERT_EQ(pacer.roomFor(frame, at(0)), at(0)) << i;
    ASSERT_TRUE(pacer.send(frame));
  }
  EXPECT_EQ(pacer.busyUntil(), at(540));
  EXPECT_EQ(pacer.roomFor(frame, at(0)), at(270));
  EXPECT_EQ(pacer.roomFor(frame, at(200)), at(270)) << "room for one is not enough to begin again";
  EXPECT_EQ(pacer.roomFor(frame, at(270)), at(270));
  EXPECT_EQ(sink.frames, 4);
}

TEST_F(PacerTest, CountsBulkFramesBitByBit) {
  pacer.sendBulk(Frame(0, {}));
  EXPECT_EQ(pacer.busyUntil(), at(53)) << "34 bits, 6 stuff bits, 13 more";
}

TEST_F(PacerTest, TakesNothingForSentThatTheInterfaceRefused) {
  sink.full = true;
  EXPECT_FALSE(pacer.send(frame));
  EXPECT_FALSE(pacer.sendBulk(frame));
  EXPECT_LE(pacer.busyUntil(), at(0));
}

TEST_F(PacerTest, FramesOfOthersHoldUpWhatWaits) {
  pacer.send(frame);
  pacer.heard(Frame(0x181, {1, 2}), at(10));  // 34 + 16 + 13 + 12 bits at most
  EXPECT_EQ(pacer.busyUntil(), at(135 + 75));
  pacer.heard(frame, at(300));
  EXPECT_EQ(pacer.busyUntil(), at(210)) << "nothing waited any more";
}

TEST_F(PacerTest, NothingIsSentThatWouldStillBeOnTheWireWhenSyncIsDue) {
  pacer.syncSent(at(0), milliseconds(4));
  pacer.setTime(at(3864));
  EXPECT_EQ(pacer.roomFor(frame, at(3864)), at(3864));
  EXPECT_EQ(pacer.roomFor(frame, at(3866)), at(4000)) << "135 bits would end at 4001";
  pacer.send(frame);
  EXPECT_EQ(pacer.roomFor(frame, at(3865)), at(4000)) << "it would wait for the one before it";
}

TEST_F(PacerTest, AnOverdueSyncMayComeAnyMomentSoOnlyOneFrameIsOnItsWay) {
  pacer.syncSent(at(0), milliseconds(4));
  pacer.setTime(at(4100));
  EXPECT_EQ(pacer.roomFor(frame, at(4100)), at(4100));
  pacer.send(frame);
  EXPECT_EQ(pacer.roomFor(frame, at(4100)), at(4235));
}

TEST_F(PacerTest, WhereSyncStoppedItIsNoLongerWaitedFor) {
  pacer.syncSent(at(0), milliseconds(4));
  pacer.setTime(at(12001));
  pacer.send(frame);
  EXPECT_EQ(pacer.roomFor(frame, at(12001)), at(12001));
}

TEST_F(PacerTest, WithASyncTooFrequentForTwoFramesItIsDisregarded) {
  pacer.syncSent(at(0), microseconds(200));
  EXPECT_EQ(pacer.roomFor(frame, at(150)), at(150)) << "else nothing would ever be sent";
}

TEST_F(PacerTest, WithoutABitRateNothingIsHeldBack) {
  Pacer open(sink, 0.0);
  open.setTime(at(0));
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(open.roomFor(frame, at(0)), at(0));
    open.sendBulk(frame);
  }
}

}  // namespace
}  // namespace cia402::can
