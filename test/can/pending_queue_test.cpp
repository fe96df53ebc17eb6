// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/can/pending_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace cia402::can {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A kernel with room for a number of frames.
struct Kernel {
  std::size_t room = 0;
  std::vector<std::uint32_t> sent;
  bool operator()(const Frame& frame) {
    if (room == 0) return false;
    --room;
    sent.push_back(frame.id);
    return true;
  }
};

TEST(PendingQueue, KeepsTheOrderWhileTheKernelTakesAFewAtATime) {
  PendingQueue queue(4);
  Kernel kernel;
  for (std::uint32_t id = 1; id <= 4; ++id) EXPECT_TRUE(queue.push(Frame(id, {})));
  EXPECT_EQ(queue.flush(kernel), 0u);
  kernel.room = 2;
  EXPECT_EQ(queue.flush(kernel), 2u);
  EXPECT_THAT(kernel.sent, ElementsAre(1, 2));
  EXPECT_TRUE(queue.push(Frame(5, {})));  // wraps around the end of the ring
  EXPECT_TRUE(queue.push(Frame(6, {})));
  kernel.room = 9;
  EXPECT_EQ(queue.flush(kernel), 4u);
  EXPECT_THAT(kernel.sent, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_TRUE(queue.empty());
}

TEST(PendingQueue, RefusesWhatDoesNotFit) {
  PendingQueue queue(2);
  EXPECT_TRUE(queue.push(Frame(1, {})));
  EXPECT_TRUE(queue.push(Frame(2, {})));
  EXPECT_FALSE(queue.push(Frame(3, {})));
  EXPECT_EQ(queue.size(), 2u);
  Kernel kernel;
  kernel.room = 9;
  queue.flush(kernel);
  EXPECT_THAT(kernel.sent, ElementsAre(1, 2));
}

TEST(PendingQueue, TellsHowManyItThrowsAway) {
  PendingQueue queue(4);
  queue.push(Frame(1, {}));
  queue.push(Frame(2, {}));
  EXPECT_EQ(queue.discard(), 2u);
  EXPECT_EQ(queue.discard(), 0u);
  Kernel kernel;
  kernel.room = 9;
  queue.flush(kernel);
  EXPECT_THAT(kernel.sent, IsEmpty());
}

TEST(PendingQueue, MayBeDiscardedByTheSenderItFlushesTo) {
  PendingQueue queue(4);
  queue.push(Frame(1, {}));
  queue.push(Frame(2, {}));
  int calls = 0;
  EXPECT_EQ(queue.flush([&](const Frame&) {
    ++calls;
    queue.discard();
    return true;
  }),
            0u);
  EXPECT_EQ(calls, 1);
  EXPECT_TRUE(queue.push(Frame(3, {})));
  EXPECT_EQ(queue.size(), 1u);
}

TEST(PendingQueue, HasRoomForOneFrameAtLeast) {
  PendingQueue queue(0);
  EXPECT_EQ(queue.capacity(), 1u);
  EXPECT_TRUE(queue.push(Frame(1, {})));
}

}  // namespace
}  // namespace cia402::can
