// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/mpsc_queue.h"

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

TEST(MpscQueue, LosesAndDoublesNothingOfSeveralThreads) {
  constexpr int kThreads = 3, kCount = 100000;
  struct Element {
    int thread = 0, number = 0;
  };
  MpscQueue<Element> queue(16);
  std::array<std::thread, kThreads> producers;
  for (int thread = 0; thread < kThreads; ++thread) {
    producers[static_cast<std::size_t>(thread)] = std::thread([&queue, thread] {
      for (int number = 0; number < kCount;) {
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
  for (int taken = 0; taken < kThreads * kCount;) {
    Element element;
    if (!queue.pop(element)) {
      std::this_thread::yield();
      continue;
    }
    ++taken;
    out_of_order += element.number != expected[static_cast<std::size_t>(element.thread)]++ ? 1 : 0;
  }
  for (std::thread& producer : producers) producer.join();
  EXPECT_EQ(out_of_order, 0);
  Element element;
  EXPECT_FALSE(queue.pop(element));
}

}  // namespace
}  // namespace cia402::bus
