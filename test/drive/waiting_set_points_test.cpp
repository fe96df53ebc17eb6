// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Commands that wait for each other, and how they are handed to a drive that queues them.
#include "drive/modes/waiting_set_points.h"

#include <gtest/gtest.h>

#include "drive/modes/set_point_handshake.h"

namespace cia402::drive {
namespace {

TEST(WaitingSetPoints, ComeOutInTheirOrderAndAreNoMoreThanThereIsRoomFor) {
  WaitingSetPoints waiting;
  for (int round = 0; round < 3; ++round) {  // all round the ring
    EXPECT_TRUE(waiting.empty());
    for (std::size_t i = 0; i < WaitingSetPoints::kMost; ++i) {
      EXPECT_FALSE(waiting.full());
      waiting.add(static_cast<double>(i));
    }
    EXPECT_TRUE(waiting.full());
    for (std::size_t i = 0; i < WaitingSetPoints::kMost - 3; ++i) {
      EXPECT_EQ(waiting.first(), static_cast<double>(i));
      waiting.removeFirst();
    }
    EXPECT_FALSE(waiting.empty());
    waiting.clear();
  }
}

/// A drive that queues so many, seen from a handshake.
struct QueueingWire {
  QueueingWire() {
    handover = standardHandover(true);
    handover.queued = true;
  }
  bool step(bool acknowledged) {
    now += std::chrono::milliseconds(1);
    input.acknowledged = acknowledged;
    const bool ok = handshake.advance(input, now, std::chrono::seconds(1));
    ++input.target_frames;
    ++input.controlword_frames;
    return ok;
  }
  void handOver(std::uint64_t raw) {
    handshake.offer({raw, false, true});
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(step(false));
    EXPECT_EQ(handshake.word(), 0x0010) << "not at once";
    EXPECT_TRUE(step(true));
  }
  Handover handover;
  SetPointHandshake handshake{handover};
  SetPointHandshake::Input input;
  Time now{};
};

TEST(QueueingHandshake, WaitsAsLongAsItTakesForRoom) {
  QueueingWire wire;
  wire.handOver(100);
  for (int i = 0; i < 3000; ++i) ASSERT_TRUE(wire.step(true)) << i;
  EXPECT_TRUE(wire.handshake.busy());
  EXPECT_FALSE(wire.handshake.blocked());
  EXPECT_TRUE(wire.step(false));
  EXPECT_FALSE(wire.handshake.busy());
}

TEST(QueueingHandshake, IsBlockedForWhatIsToCountAtOnceWhileTheQueueIsFull) {
  QueueingWire wire;
  wire.handOver(100);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(wire.step(true));
  wire.handshake.offer(7, true);
  EXPECT_TRUE(wire.step(true));
  EXPECT_TRUE(wire.handshake.blocked());
  EXPECT_TRUE(wire.step(false));
  EXPECT_FALSE(wire.handshake.blocked());
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(wire.step(false));
  EXPECT_EQ(wire.handshake.word(), 0x0030) << "at once";
  EXPECT_EQ(wire.handshake.raw(), 7U);
}

// A drive that takes what counts at once whatever waits, as CiA 402-2 has it.
TEST(QueueingHandshake, ReplacesAFullQueueWhereTheDriveTakesThat) {
  QueueingWire wire;
  wire.handover.replaces_queue = true;
  wire.handOver(100);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(wire.step(true));
  EXPECT_EQ(wire.handshake.word(), 0x0020);
  wire.handshake.offer(7);
  EXPECT_TRUE(wire.step(true));
  EXPECT_FALSE(wire.handshake.blocked());
  EXPECT_EQ(wire.handshake.raw(), 7U);
  int raised = 0;
  for (int i = 0; i < 6; ++i) {
    EXPECT_TRUE(wire.step(true));
    raised += wire.handshake.word() == 0x0030 ? 1 : 0;
  }
  EXPECT_GE(raised, wire.handover.each_for) << "the bit that is set already proves nothing";
  EXPECT_EQ(wire.handshake.word(), 0x0020);
  EXPECT_TRUE(wire.step(false));
  EXPECT_FALSE(wire.handshake.busy());
}

// Where nothing proves that the drive took a set-point it is handed over twice; a distance is not.
TEST(QueueingHandshake, HandsADistanceOverOnce) {
  for (const bool relative : {false, true}) {
    QueueingWire wire;
    wire.handover = Handover();
    wire.handover.words = {0x0000, 0x0020, 0x0030};
    wire.handover.acknowledge = Handover::Acknowledge::rise;
    if (relative) wire.handover.from = Handover::From::target;
    wire.handshake.offer({100, false, true});
    int edges = 0;
    std::uint16_t before = 0;
    for (int i = 0; i < 40; ++i) {
      EXPECT_TRUE(wire.step(true)) << "its bit stays set";
      const std::uint16_t word = wire.handshake.word();
      if ((word & 0x10U) != 0 && (before & 0x10U) == 0) ++edges;
      EXPECT_EQ((word & 0x40U) != 0, relative && word != 0);
      before = word;
    }
    EXPECT_EQ(edges, relative ? 1 : 2);
    EXPECT_FALSE(wire.handshake.busy());
  }
}

TEST(QueueingHandshake, GivesUpWhatIsToCountAtOnceAfterItsTime) {
  QueueingWire wire;
  wire.handOver(100);
  wire.handshake.offer(7);
  int cycles = 0;
  while (cycles < 3000 && wire.step(true)) ++cycles;
  EXPECT_GE(cycles, 998);
  EXPECT_LE(cycles, 1002);
}

}  // namespace
}  // namespace cia402::drive
