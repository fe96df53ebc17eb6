// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/repeat_limiter.h"

#include <gtest/gtest.h>

#include <random>

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;
using Verdict = RepeatLimiter::Verdict;

struct RepeatLimiterTest : testing::Test {
  Verdict take(std::uint32_t kind = 1) { return limiter.take(kind, now); }
  RepeatLimiter limiter;
  Time now{100s};
};

TEST_F(RepeatLimiterTest, TellsTheFirstThreeAtOnceAndSumsUpTheRest) {
  EXPECT_EQ(take(), Verdict::tell);
  EXPECT_EQ(take(), Verdict::tell);
  EXPECT_EQ(take(), Verdict::tell_last);
  now += 1s;
  for (int i = 0; i < 40; ++i) EXPECT_EQ(take(), Verdict::hold);
  now += 3999ms;
  EXPECT_FALSE(limiter.due(now));
  now += 1ms;
  const auto summary = limiter.due(now);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->kind, 1u);
  EXPECT_FALSE(summary->others);
  EXPECT_EQ(summary->count, 40u);
  EXPECT_EQ(summary->over, 5s);
  EXPECT_EQ(summary->total, 43u);
  EXPECT_FALSE(limiter.due(now));
}

TEST_F(RepeatLimiterTest, TellsNothingAtOnceWhileAStormGoesOn) {
  for (int i = 0; i < 4; ++i) take();
  now += 5s;
  ASSERT_TRUE(limiter.due(now));
  EXPECT_EQ(take(), Verdict::hold);
  now += 5s;
  const auto summary = limiter.due(now);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->count, 1u);
  EXPECT_EQ(summary->total, 5u);
}

TEST_F(RepeatLimiterTest, TellsAtOnceAgainAfterAQuietInterval) {
  for (int i = 0; i < 4; ++i) take();
  now += 5s;
  ASSERT_TRUE(limiter.due(now));
  now += 5s;
  EXPECT_FALSE(limiter.due(now));
  EXPECT_EQ(limiter.deadline(), kNever);
  EXPECT_EQ(take(), Verdict::tell);
}

TEST_F(RepeatLimiterTest, TellsSlowNewsAlways) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(take(), Verdict::tell) << i;
    now += 5s;
  }
  EXPECT_FALSE(limiter.due(now));
}

TEST_F(RepeatLimiterTest, TellsKindsApart) {
  for (int i = 0; i < 4; ++i) take(1);
  EXPECT_EQ(take(2), Verdict::tell);
  now += 5s;
  const auto summary = limiter.due(now);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->kind, 1u);
  EXPECT_EQ(summary->count, 1u);
  EXPECT_FALSE(limiter.due(now));
}

TEST_F(RepeatLimiterTest, SumsUpKindsThatItHasNoRoomFor) {
  for (std::uint32_t kind = 0; kind < RepeatLimiter::kKinds; ++kind) {
    EXPECT_EQ(take(kind), Verdict::tell);
  }
  EXPECT_EQ(take(1000), Verdict::hold);
  EXPECT_EQ(take(1001), Verdict::hold);
  EXPECT_EQ(limiter.others(), 2u);
  now += 5s;
  const auto summary = limiter.due(now);
  ASSERT_TRUE(summary);
  EXPECT_TRUE(summary->others);
  EXPECT_EQ(summary->count, 2u);
}

TEST_F(RepeatLimiterTest, GivesTheRestBeforeItIsDue) {
  for (int i = 0; i < 5; ++i) take();
  EXPECT_FALSE(limiter.due(now));
  const auto summary = limiter.rest(now + 1s);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->count, 2u);
  EXPECT_EQ(summary->over, 1s);
  EXPECT_FALSE(limiter.rest(now + 1s));
}

TEST_F(RepeatLimiterTest, LosesNoCountWhateverComes) {
  std::mt19937 random(5);
  std::uint64_t came = 0, told = 0, summed = 0;
  for (int i = 0; i < 200'000; ++i) {
    now += std::chrono::microseconds(random() % (i % 1000 == 0 ? 8'000'000 : 2'000));
    ++came;
    told += take(static_cast<std::uint32_t>(random() % 24)) == Verdict::hold ? 0 : 1;
    if (i % 4 == 0) {
      while (const auto summary = limiter.due(now)) summed += summary->count;
    }
  }
  while (const auto summary = limiter.rest(now)) summed += summary->count;
  EXPECT_EQ(told + summed, came);
  std::uint64_t counted = limiter.others();
  for (std::size_t i = 0; i < limiter.kinds(); ++i) counted += limiter.count(i).total;
  EXPECT_EQ(counted, came);
}

TEST_F(RepeatLimiterTest, KnowsWhenEachKindCameLast) {
  take(7);
  now += 1s;
  for (int i = 0; i < 4; ++i) take(7);
  const Time last = now;
  now += 1s;
  take(8);
  ASSERT_EQ(limiter.kinds(), 2u);
  EXPECT_EQ(limiter.count(0).last, last) << "though it was held back";
  EXPECT_EQ(limiter.count(1).last, now);
}

TEST_F(RepeatLimiterTest, SumsUpNoKindBeforeItsOwnIntervalIsOver) {
  for (int i = 0; i < 4; ++i) take(1);
  now += 3s;
  for (int i = 0; i < 4; ++i) take(2);
  now += 2s;
  const auto first = limiter.due(now);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->kind, 1u);
  EXPECT_FALSE(limiter.due(now));
  now += 3s;
  const auto second = limiter.due(now);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->kind, 2u);
}

}  // namespace
}  // namespace cia402::bus
