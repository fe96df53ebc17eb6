// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/spsc_queue.h"

#include <memory>
#include <thread>

#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

TEST(SpscQueue, GivesElementsInTheirOrder) {
  SpscQueue<int> queue(3);
  for (int value : {1, 2, 3}) EXPECT_TRUE(queue.push(std::move(value)));
  int value = 0;
  for (int expected : {1, 2, 3}) {
    ASSERT_TRUE(queue.pop(value));
    EXPECT_EQ(value, expected);
  }
  EXPECT_FALSE(queue.pop(value));
  EXPECT_TRUE(queue.empty());
}

TEST(SpscQueue, RefusesWhatFindsNoRoomAndLeavesItUntouched) {
  SpscQueue<std::unique_ptr<int>> queue(1);
  ASSERT_TRUE(queue.push(std::make_unique<int>(1)));
  auto second = std::make_unique<int>(2);
  EXPECT_FALSE(queue.push(std::move(second)));
  ASSERT_NE(second, nullptr);  // NOLINT: that is the promise
  std::unique_ptr<int> taken;
  ASSERT_TRUE(queue.pop(taken));
  EXPECT_EQ(*taken, 1);
  EXPECT_TRUE(queue.push(std::move(second)));
}

/// Sends 0, 1, 2, ... from one thread to another. @return how many came in another place.
int outOfOrder(std::size_t capacity, int count) {
  SpscQueue<int> queue(capacity);
  std::thread producer([&] {
    for (int value = 0; value < count;) {
      int next = value;
      if (queue.push(std::move(next))) {
        ++value;
      } else {
        std::this_thread::yield();
      }
    }
  });
  int out_of_order = 0;
  for (int expected = 0; expected < count;) {
    int value = -1;
    if (!queue.pop(value)) {
      std::this_thread::yield();
      continue;
    }
    out_of_order += value != expected ? 1 : 0;
    ++expected;
  }
  producer.join();
  EXPECT_TRUE(queue.empty());
  return out_of_order;
}

// On one processor the threads take turns as often as the queue is full, and each turn may wait for
// other programs: few elements through the small queue, many through the large one.
TEST(SpscQueue, LosesAndDoublesNothingBetweenTwoThreads) {
  EXPECT_EQ(outOfOrder(2, 400), 0);
  EXPECT_EQ(outOfOrder(4000, 400000), 0);
}

}  // namespace
}  // namespace cia402::bus
