// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/triple_buffer.h"

#include <array>
#include <thread>

#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

TEST(TripleBuffer, ShowsTheInitialValueUntilSomethingIsPublished) {
  TripleBuffer<int> buffer(7);
  EXPECT_FALSE(buffer.refresh());
  EXPECT_EQ(buffer.front(), 7);
}

TEST(TripleBuffer, ShowsAValueOnlyOncePublishedAndRefreshed) {
  TripleBuffer<int> buffer;
  buffer.back() = 1;
  EXPECT_FALSE(buffer.refresh());
  buffer.publish();
  EXPECT_EQ(buffer.front(), 0);
  EXPECT_TRUE(buffer.refresh());
  EXPECT_EQ(buffer.front(), 1);
  EXPECT_FALSE(buffer.refresh());
  EXPECT_EQ(buffer.front(), 1);
}

TEST(TripleBuffer, SkipsToTheNewestValue) {
  TripleBuffer<int> buffer;
  for (int value = 1; value <= 5; ++value) {
    buffer.back() = value;
    buffer.publish();
  }
  EXPECT_TRUE(buffer.refresh());
  EXPECT_EQ(buffer.front(), 5);
}

TEST(TripleBuffer, NeverTearsAValueNorGoesBackBetweenTwoThreads) {
  constexpr std::uint64_t kLast = 300000;
  using Stamps = std::array<std::uint64_t, 64>;  // several cache lines
  TripleBuffer<Stamps> buffer(Stamps{});
  std::thread writer([&] {
    for (std::uint64_t stamp = 1; stamp <= kLast; ++stamp) {
      buffer.back().fill(stamp);
      buffer.publish();
    }
  });
  std::uint64_t torn = 0, backwards = 0, newest = 0;
  while (newest < kLast) {
    if (!buffer.refresh()) {
      std::this_thread::yield();
      continue;
    }
    const Stamps& stamps = buffer.front();
    for (std::uint64_t stamp : stamps) torn += stamp != stamps[0] ? 1 : 0;
    backwards += stamps[0] <= newest ? 1 : 0;
    newest = stamps[0];
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(backwards, 0u);
}

}  // namespace
}  // namespace cia402::bus
