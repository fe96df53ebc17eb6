// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sync/sync.h"

#include <gtest/gtest.h>

#include "canopen/scripted_peer.h"

namespace cia402::canopen {
namespace {

TEST(SyncProducer, without_a_counter_sends_no_data) {
  SyncProducer sync(0);
  EXPECT_EQ(test::text(sync.next()), "080");
  EXPECT_EQ(test::text(sync.next()), "080");
}

TEST(SyncProducer, counts_from_1_to_the_overflow_value_and_starts_at_1_again) {
  SyncProducer sync(3);
  for (const char* expected : {"080 01", "080 02", "080 03", "080 01", "080 02"}) {
    EXPECT_EQ(test::text(sync.next()), expected);
  }
}

TEST(SyncProducer, reaches_240_the_highest_counter_there_is) {
  SyncProducer sync(240);
  for (int i = 0; i < 239; ++i) sync.next();
  EXPECT_EQ(test::text(sync.next()), "080 F0");
  EXPECT_EQ(test::text(sync.next()), "080 01");
}

TEST(SyncProducer, restarts_at_1) {
  SyncProducer sync(10);
  sync.next();
  sync.next();
  sync.restart();
  EXPECT_EQ(test::text(sync.next()), "080 01");
}

using std::chrono::milliseconds;
constexpr Duration kPeriod = std::chrono::milliseconds(4);
Time us(int value) { return Time(std::chrono::seconds(1) + std::chrono::microseconds(value)); }
can::Frame sync(const char* text = "080") { return test::frame(text); }

TEST(SyncConsumer, is_lost_when_three_in_a_row_are_missing_and_says_so_once) {
  SyncConsumer consumer(kPeriod, 0);
  EXPECT_EQ(consumer.state(), SyncConsumer::State::waiting);
  EXPECT_FALSE(consumer.tick(us(1000000))) << "what never came is not lost";
  EXPECT_TRUE(consumer.receive(sync(), us(0)).returned);
  EXPECT_FALSE(consumer.receive(sync(), us(4000)).returned);
  EXPECT_EQ(consumer.deadline(), us(18000)) << "the third is half a period late";
  EXPECT_FALSE(consumer.tick(us(17999)));
  EXPECT_TRUE(consumer.tick(us(18000)));
  EXPECT_FALSE(consumer.tick(us(18001)));
  EXPECT_EQ(consumer.state(), SyncConsumer::State::lost);
  EXPECT_TRUE(consumer.receive(sync(), us(50000)).returned);
  EXPECT_EQ(consumer.state(), SyncConsumer::State::running);
}

TEST(SyncConsumer, counts_the_syncs_that_a_gap_lacks) {
  SyncConsumer consumer(kPeriod, 0);
  consumer.receive(sync(), us(0));
  EXPECT_EQ(consumer.receive(sync(), us(5900)).missed, 0U);
  EXPECT_EQ(consumer.receive(sync(), us(5900 + 11900)).missed, 2U);
  EXPECT_EQ(consumer.missed(), 2U);
  EXPECT_EQ(consumer.received(), 3U);
}

TEST(SyncConsumer, tells_how_far_an_interval_is_off) {
  SyncConsumer consumer(kPeriod, 0);
  EXPECT_FALSE(consumer.receive(sync(), us(0)).regular);
  const SyncConsumer::Observation late = consumer.receive(sync(), us(4300));
  EXPECT_TRUE(late.regular);
  EXPECT_EQ(late.deviation, std::chrono::microseconds(300));
  EXPECT_EQ(consumer.receive(sync(), us(8000)).deviation, -std::chrono::microseconds(300));
}

TEST(SyncConsumer, measures_the_period_and_compares_it) {
  for (const int interval : {4000, 4190, 3810, 4210, 3790, 5000, 8000, 2000}) {
    SyncConsumer consumer(kPeriod, 0);
    for (int i = 0; i < SyncConsumer::kWindow; ++i) consumer.receive(sync(), us(i * interval));
    EXPECT_FALSE(consumer.periodWrong()) << "too few to tell";
    EXPECT_EQ(consumer.period(), Duration::zero());
    consumer.receive(sync(), us(SyncConsumer::kWindow * interval));
    EXPECT_EQ(consumer.period(), std::chrono::microseconds(interval));
    EXPECT_EQ(consumer.periodWrong(), interval < 3800 || interval > 4200) << interval;
  }
}

TEST(SyncConsumer, leaves_single_gaps_out_of_the_period) {
  SyncConsumer consumer(kPeriod, 0);
  int time = 0;
  for (int i = 0; i <= SyncConsumer::kWindow; ++i) {
    consumer.receive(sync(), us(time += i % 4 == 0 ? 8000 : 4000));
  }
  EXPECT_EQ(consumer.period(), kPeriod);
  EXPECT_FALSE(consumer.periodWrong());
  EXPECT_EQ(consumer.missed(), 4U);
}

TEST(SyncConsumer, sees_a_counter_that_is_missing_or_not_expected) {
  SyncConsumer without(kPeriod, 0);
  for (int i = 1; i <= SyncConsumer::kOddForms; ++i) {
    EXPECT_FALSE(without.formWrong()) << "a stray one is no reason";
    without.receive(sync("080 01"), us(4000 * i));
  }
  EXPECT_TRUE(without.formWrong());
  without.receive(sync(), us(16000));
  EXPECT_FALSE(without.formWrong());
  for (int i = 1; i < SyncConsumer::kOddForms; ++i) {
    without.receive(sync("080 01"), us(16000 + 4000 * i));
  }
  EXPECT_FALSE(without.formWrong()) << "not three in a row";
  SyncConsumer with(kPeriod, 3);
  for (int i = 1; i <= SyncConsumer::kOddForms; ++i) with.receive(sync(), us(4000 * i));
  EXPECT_TRUE(with.formWrong());
}

TEST(SyncConsumer, counts_counters_that_do_not_follow_each_other) {
  SyncConsumer consumer(kPeriod, 3);
  int time = 0;
  for (const char* text : {"080 02", "080 03", "080 01", "080 02"}) {
    consumer.receive(sync(text), us(time += 4000));
  }
  EXPECT_EQ(consumer.counterErrors(), 0U);
  consumer.receive(sync("080 01"), us(time += 4000));
  EXPECT_EQ(consumer.counterErrors(), 1U);
}

TEST(SyncConsumer, takes_any_counter_after_one_without) {
  SyncConsumer consumer(kPeriod, 10);
  int time = 0;
  for (const char* text : {"080 02", "080", "080 07", "080 08"}) {
    consumer.receive(sync(text), us(time += 4000));
  }
  EXPECT_EQ(consumer.counterErrors(), 0U);
  consumer.receive(sync("080 0A"), us(time += 4000));
  EXPECT_EQ(consumer.counterErrors(), 1U);
}

TEST(SyncConsumer, measures_anew_when_sync_comes_back) {
  SyncConsumer consumer(kPeriod, 0);
  for (int i = 0; i < SyncConsumer::kWindow; ++i) consumer.receive(sync(), us(i * 4000));
  EXPECT_TRUE(consumer.tick(us(100000)));  // one interval was missing to a measurement
  consumer.receive(sync(), us(100000));
  for (int i = 1; i < SyncConsumer::kWindow; ++i) consumer.receive(sync(), us(100000 + i * 3000));
  EXPECT_EQ(consumer.period(), Duration::zero());
  consumer.receive(sync(), us(100000 + SyncConsumer::kWindow * 3000));
  EXPECT_EQ(consumer.period(), std::chrono::milliseconds(3));
}

TEST(SyncConsumer, lacks_no_sync_in_an_interval_of_one_and_a_half_periods) {
  SyncConsumer consumer(kPeriod, 0);
  consumer.receive(sync(), us(0));
  EXPECT_EQ(consumer.receive(sync(), us(6000)).missed, 0U);
  EXPECT_EQ(consumer.receive(sync(), us(6000 + 6001)).missed, 1U);
}

TEST(SyncConsumer, takes_long_intervals_for_the_period_where_most_are_long) {
  const auto measured = [](int of_4_ms, int of_8_ms) {
    SyncConsumer consumer(kPeriod, 0);
    int time = 0;
    consumer.receive(sync(), us(time));
    for (int i = 0; i < of_4_ms; ++i) consumer.receive(sync(), us(time += 4000));
    for (int i = 0; i < of_8_ms; ++i) consumer.receive(sync(), us(time += 8000));
    return consumer.period();
  };
  EXPECT_EQ(measured(9, 7), milliseconds(4));
  EXPECT_EQ(measured(7, 9), std::chrono::microseconds(6250)) << "(7 * 4 + 9 * 8) / 16 ms";
}

TEST(SyncConsumer, forgets_what_it_measured_before) {
  SyncConsumer consumer(kPeriod, 0);
  int time = 0;
  consumer.receive(sync(), us(time));
  for (int i = 0; i < SyncConsumer::kWindow; ++i) consumer.receive(sync(), us(time += 4000));
  for (int i = 0; i < SyncConsumer::kWindow; ++i) consumer.receive(sync(), us(time += 5000));
  EXPECT_EQ(consumer.period(), milliseconds(5));
}

}  // namespace
}  // namespace cia402::canopen
