// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/mpsc_queue.h"

#include <array>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

TEST(MpscQueue, GivesElementsInTheirOrderRoundAfterRound) {
  MpscQueue<int> queue(3);
  int value = 0;
  for (int round = 0; round < 5; ++round) {
    for (int i : {1, 2, 3}) EXPECT_TRUE(queue.push(10 * round + i));
    for (int i : {1, 2, 3}) {
      ASSERT_TRUE(queue.pop(value));
      EXPECT_EQ(value, 10 * round + i);
    }
    EXPECT_FALSE(queue.pop(value));
  }
}

TEST(MpscQueue, RefusesWhatFindsNoRoomAndLeavesItUntouched) {
  MpscQueue<std::unique_ptr<int>> queue(2);
  ASSERT_TRUE(queue.push(std::make_unique<int>(1)));
  ASSERT_TRUE(queue.push(std::make_unique<int>(2)));
  auto third = std::make_unique<int>(3);
  EXPECT_FALSE(queue.push(std::move(third)));
  ASSERT_NE(third, nullptr);  // NOLINT: that is the promise
  std::unique_ptr<int> taken;
  ASSERT_TRUE(queue.pop(taken));
  EXPECT_EQ(*taken, 1);
  EXPECT_TRUE(queue.push(std::move(third)));
}

/// Each of three threads sends 0, 1, 2, ... to one. @return how many came in another place among
/// those of their thread.
int outOfOrder(std::size_t capacity, int count) {
  constexpr std::size_t kThreads = 3;
  struct Element {
    std::size_t thread = 0;
    int number = 0;
  };
  MpscQueue<Element> queue(capacity);
  std::array<std::thread, kThreads> producers;
  for (std::size_t thread = 0; thread < kThreads; ++thread) {
    producers[thread] = std::thread([&queue, thread, count] {
      for (int number = 0; number < count;) {
        if (queue.push({thread, number})) {
          ++number;
        } else {
          std::this_thread::yield();
        }
      }
    });
  }
  std::array<int, kThreads> expected{};
  int out_of_order = 0;
  for (int left = static_cast<int>(kThreads) * count; left > 0;) {
    Element element;
    if (!queue.pop(element)) {
      std::this_thread::yield();
      continue;
    }
    --left;
    out_of_order += element.number != expected[element.thread]++ ? 1 : 0;
  }
  for (std::thread& producer : producers) producer.join();
  Element element;
  EXPECT_FALSE(queue.pop(element));
  return out_of_order;
}

// On one processor the threads take turns as often as the queue is full, and each turn may wait for
// other programs: few elements through the small queue, many through the large one.
TEST(MpscQueue, LosesAndDoublesNothingOfSeveralThreads) {
  EXPECT_EQ(outOfOrder(2, 50), 0);
  EXPECT_EQ(outOfOrder(4000, 150000), 0);
}

}  // namespace
}  // namespace cia402::bus
