// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/record_ring.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace cia402::can {
namespace {

struct Number {
  std::uint64_t a = 0, b = 0, c = 0;
};

std::vector<std::uint64_t> numbersOf(const RecordRing<Number>& ring) {
  std::vector<std::uint64_t> numbers;
  for (const Number& record : ring.copy()) numbers.push_back(record.a);
  return numbers;
}

void push(RecordRing<Number>& ring, std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t i = first; i <= last; ++i) ring.push({i, i, i});
}

TEST(RecordRing, HandsOutWhatWasWrittenInOrder) {
  RecordRing<Number> ring(4);
  EXPECT_TRUE(ring.copy().empty());
  push(ring, 1, 3);
  EXPECT_EQ(numbersOf(ring), (std::vector<std::uint64_t>{1, 2, 3}));
  EXPECT_EQ(ring.written(), 3U);
}

TEST(RecordRing, KeepsTheNewestRecords) {
  RecordRing<Number> ring(4);
  push(ring, 1, 4);
  EXPECT_EQ(numbersOf(ring), (std::vector<std::uint64_t>{1, 2, 3, 4}));
  push(ring, 5, 5);
  EXPECT_EQ(numbersOf(ring), (std::vector<std::uint64_t>{2, 3, 4, 5}));
  push(ring, 6, 1003);
  EXPECT_EQ(numbersOf(ring), (std::vector<std::uint64_t>{1000, 1001, 1002, 1003}));
}

TEST(RecordRing, HoldsAtLeastOne) {
  RecordRing<Number> ring(0);
  push(ring, 1, 2);
  EXPECT_EQ(numbersOf(ring), std::vector<std::uint64_t>{2});
}

TEST(RecordRing, TellsItsMemory) {
  const RecordRing<Number> ring(100);
  EXPECT_EQ(ring.capacity(), 100U);
  EXPECT_EQ(ring.memory(), 101U * 24U);
}

TEST(RecordRing, ACopyTakenWhileItIsWrittenHoldsWholeRecordsInOrder) {
  RecordRing<Number> ring(64);
  std::atomic<bool> end{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; !end; ++i) ring.push({i, i, i});
  });
  while (ring.written() < 1000) std::this_thread::yield();
  for (int i = 0; i < 2000; ++i) {
    std::uint64_t before = 0;
    for (const Number& record : ring.copy()) {
      ASSERT_EQ(record.a, record.b);
      ASSERT_EQ(record.a, record.c);
      if (before != 0) {
        ASSERT_EQ(record.a, before + 1);
      }
      before = record.a;
    }
  }
  end = true;
  writer.join();
}

}  // namespace
}  // namespace cia402::can
