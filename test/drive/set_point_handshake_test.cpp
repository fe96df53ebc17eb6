// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/drive/set_point_handshake.h"

#include <gtest/gtest.h>

namespace cia402::drive {
namespace {

constexpr Duration kTimeout = std::chrono::seconds(1);

struct Wire {
  SetPointHandshake handshake;
  SetPointHandshake::Input input;
  Time now{};
  bool step(bool acknowledged) {
    now += std::chrono::milliseconds(1);
    input.acknowledged = acknowledged;
    const bool ok = handshake.advance(input, now, kTimeout);
    ++input.target_frames;  // each cycle sends both RPDOs
    ++input.controlword_frames;
    return ok;
  }
};

TEST(SetPointHandshake, SendsTheTargetBeforeTheEdge) {
  Wire wire;
  wire.handshake.offer(100);
  EXPECT_TRUE(wire.step(false));
  EXPECT_EQ(wire.handshake.raw(), 100u);
  EXPECT_FALSE(wire.handshake.bit());
  EXPECT_TRUE(wire.step(false));
  EXPECT_TRUE(wire.handshake.bit());
}

TEST(SetPointHandshake, MakesNoEdgeWhileTheTargetHasNotLeft) {
  Wire wire;
  wire.handshake.offer(100);
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(wire.step(false));
    wire.input.target_frames = 0;
    EXPECT_FALSE(wire.handshake.bit());
  }
}

TEST(SetPointHandshake, HoldsTheBitUntilAcknowledgedThenWaitsForTheFall) {
  Wire wire;
  wire.handshake.offer(100);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(wire.step(false));
  EXPECT_TRUE(wire.handshake.bit());
  EXPECT_TRUE(wire.step(true));
  EXPECT_FALSE(wire.handshake.bit());
  EXPECT_TRUE(wire.handshake.busy());
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(wire.step(true));
  EXPECT_TRUE(wire.handshake.busy());
  EXPECT_TRUE(wire.step(false));
  EXPECT_FALSE(wire.handshake.busy());
}

TEST(SetPointHandshake, KeepsTheTargetUnchangedWhileTheBitIsHigh) {
  Wire wire;
  wire.handshake.offer(100);
  wire.step(false);
  wire.step(false);
  ASSERT_TRUE(wire.handshake.bit());
  wire.handshake.offer(200);
  wire.handshake.offer(300);
  wire.step(false);
  EXPECT_EQ(wire.handshake.raw(), 100u);
  wire.step(true);
  wire.step(true);
  wire.step(false);  // idle again
  wire.step(false);
  EXPECT_EQ(wire.handshake.raw(), 300u);
}

TEST(SetPointHandshake, DoesNotBeginWhileAnOldAcknowledgeStands) {
  Wire wire;
  wire.handshake.offer(100);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(wire.step(true));
  EXPECT_FALSE(wire.handshake.bit());
  EXPECT_EQ(wire.handshake.raw(), 0u);
}

TEST(SetPointHandshake, GivesUpWithTheBitLow) {
  Wire wire;
  wire.handshake.offer(100);
  int steps = 0;
  while (wire.step(false) && steps < 5000) ++steps;
  EXPECT_GT(steps, 990);
  EXPECT_LT(steps, 1010);
  EXPECT_FALSE(wire.handshake.bit());
  EXPECT_FALSE(wire.handshake.busy());
}

TEST(SetPointHandshake, PulsesWithoutAnAcknowledgeBit) {
  Wire wire;
  wire.input.has_acknowledge = false;
  wire.handshake.offer(100);
  int high = 0;
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(wire.step(false));
    if (wire.handshake.bit()) ++high;
  }
  EXPECT_EQ(high, 2);
  EXPECT_FALSE(wire.handshake.busy());
}

}  // namespace
}  // namespace cia402::drive
