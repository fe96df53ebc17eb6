// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/pending_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace cia402::can {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A kernel with room for a number of frames.
struct Kernel {
  std::size_t room = 0;
  std::vector<std::uint32_t> sent;
  std::vector<unsigned> first_bytes;
  bool operator()(const Frame& frame) {
    if (room == 0) return false;
    --room;
    sent.push_back(frame.id);
    first_bytes.push_back(frame.data[0]);
    return true;
  }
};

constexpr PendingQueue::Patience kPatient{};
constexpr PendingQueue::Patience kNewest{8ms, true};

struct PendingQueueTest : testing::Test {
  bool push(std::uint32_t id, PendingQueue::Patience patience = kPatient, std::uint8_t byte = 0) {
    return queue.push(Frame(id, {byte}), now, patience);
  }
  std::size_t flush() { return queue.flush(now, kernel); }
  PendingQueue queue{4};
  Kernel kernel;
  Time now{1s};
};

TEST_F(PendingQueueTest, KeepsTheOrderWhileTheKernelTakesAFewAtATime) {
  for (std::uint32_t id = 1; id <= 4; ++id) EXPECT_TRUE(push(id));
  EXPECT_EQ(flush(), 0u);
  kernel.room = 2;
  EXPECT_EQ(flush(), 2u);
  EXPECT_THAT(kernel.sent, ElementsAre(1, 2));
  EXPECT_TRUE(push(5));  // wraps around the end of the ring
  EXPECT_TRUE(push(6));
  kernel.room = 9;
  EXPECT_EQ(flush(), 4u);
  EXPECT_THAT(kernel.sent, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_TRUE(queue.empty());
}

TEST_F(PendingQueueTest, RefusesWhatDoesNotFit) {
  for (std::uint32_t id = 1; id <= 4; ++id) EXPECT_TRUE(push(id));
  EXPECT_FALSE(push(5));
  EXPECT_FALSE(push(6, kNewest));
  EXPECT_EQ(queue.size(), 4u);
  kernel.room = 9;
  flush();
  EXPECT_THAT(kernel.sent, ElementsAre(1, 2, 3, 4));
}

TEST_F(PendingQueueTest, LeavesOutFramesWhoseTimeIsOver) {
  push(0x201, {8ms, false}, 1);
  push(0x601);
  now += 7ms;
  push(0x201, {8ms, false}, 2);
  now += 1ms;
  kernel.room = 9;
  EXPECT_EQ(flush(), 2u);
  EXPECT_THAT(kernel.sent, ElementsAre(0x601, 0x201));
  EXPECT_THAT(kernel.first_bytes, ElementsAre(0, 2));
  EXPECT_EQ(queue.stale(), 1u);
}

TEST_F(PendingQueueTest, KeepsTheNewestOfAnIdentifierOnlyInThePlaceOfTheOldest) {
  push(0x201, kNewest, 1);
  push(0x601, kPatient, 7);
  push(0x601, kPatient, 8);
  now += 7ms;
  push(0x201, kNewest, 2);
  now += 7ms;
  EXPECT_EQ(queue.size(), 3u);
  EXPECT_EQ(queue.stale(), 1u);
  kernel.room = 9;
  flush();
  EXPECT_THAT(kernel.sent, ElementsAre(0x201, 0x601, 0x601));
  EXPECT_THAT(kernel.first_bytes, ElementsAre(2, 7, 8));
}

TEST_F(PendingQueueTest, TellsIdentifiersOf11And29BitsApart) {
  push(0x201, kNewest, 1);
  Frame extended(0x201, {2});
  extended.extended = true;
  EXPECT_TRUE(queue.push(extended, now, kNewest));
  EXPECT_EQ(queue.size(), 2u);
}

TEST_F(PendingQueueTest, ReplacesInAFullQueue) {
  for (std::uint32_t id = 1; id <= 4; ++id) push(id, kNewest);
  EXPECT_TRUE(push(3, kNewest, 9));
  kernel.room = 9;
  flush();
  EXPECT_THAT(kernel.first_bytes, ElementsAre(0, 0, 9, 0));
}

TEST_F(PendingQueueTest, TellsHowManyItThrowsAway) {
  push(1);
  push(2);
  EXPECT_EQ(queue.discard(), 2u);
  EXPECT_EQ(queue.discard(), 0u);
  kernel.room = 9;
  flush();
  EXPECT_THAT(kernel.sent, IsEmpty());
}

TEST_F(PendingQueueTest, MayBeDiscardedByTheSenderItFlushesTo) {
  push(1);
  push(2);
  int calls = 0;
  EXPECT_EQ(queue.flush(now,
                        [&](const Frame&) {
                          ++calls;
                          queue.discard();
                          return true;
                        }),
            0u);
  EXPECT_EQ(calls, 1);
  EXPECT_TRUE(push(3));
  EXPECT_EQ(queue.size(), 1u);
}

TEST(PendingQueue, HasRoomForOneFrameAtLeast) {
  PendingQueue queue(0);
  EXPECT_EQ(queue.capacity(), 1u);
  EXPECT_TRUE(queue.push(Frame(1, {}), Time(), {}));
}

}  // namespace
}  // namespace cia402::can
