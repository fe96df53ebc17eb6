// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/sync_producer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace cia402::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::ElementsAre;

class SyncProducerTest : public testing::Test, public can::Sink {
 protected:
  SyncProducerTest() { producer.connect(*this); }
  bool send(const can::Frame& frame) override {
    frames.push_back(frame);
    times.push_back(now);
    return true;
  }
  void run(Duration duration) {
    const Time end = now + duration;
    while (producer.nextDeadline() <= end) {
      now = producer.nextDeadline();
      producer.tick(now);
    }
    now = end;
  }
  SyncProducer producer{7};
  Time now{};
  std::vector<can::Frame> frames;
  std::vector<Time> times;
};

TEST_F(SyncProducerTest, SendsEmptyFramesOnAnExactGrid) {
  run(milliseconds(10));
  EXPECT_TRUE(frames.empty());
  SyncSchedule schedule;
  schedule.period = milliseconds(2);
  producer.start(schedule, now);
  run(milliseconds(5));
  EXPECT_THAT(frames,
              ElementsAre(can::Frame(0x80, {}), can::Frame(0x80, {}), can::Frame(0x80, {})));
  EXPECT_THAT(times,
              ElementsAre(Time(milliseconds(10)), Time(milliseconds(12)), Time(milliseconds(14))));
  EXPECT_EQ(producer.sent(), 3U);
}

TEST_F(SyncProducerTest, CountsFromOneToTheOverflowAndAgainAfterARestart) {
  SyncSchedule schedule;
  schedule.period = milliseconds(1);
  schedule.counter_overflow = 3;
  schedule.cob_id = 0x81;
  producer.start(schedule, now);
  run(milliseconds(4));
  producer.stop();
  run(milliseconds(10));
  producer.start(schedule, now);
  run(milliseconds(0));
  EXPECT_THAT(frames,
              ElementsAre(can::Frame(0x81, {1}), can::Frame(0x81, {2}), can::Frame(0x81, {3}),
                          can::Frame(0x81, {1}), can::Frame(0x81, {2}), can::Frame(0x81, {1})));
}

TEST_F(SyncProducerTest, JitterDelaysSingleSyncsWithoutDrift) {
  SyncSchedule schedule;
  schedule.period = milliseconds(1);
  schedule.jitter = microseconds(200);
  producer.start(schedule, now);
  run(milliseconds(1000));
  ASSERT_GE(times.size(), 1000U);
  Duration least = milliseconds(1), most{};
  for (std::size_t i = 0; i < 1000; ++i) {
    const Duration late = times[i] - Time(milliseconds(i));
    least = std::min(least, late);
    most = std::max(most, late);
  }
  EXPECT_GE(least, Duration::zero());
  EXPECT_LT(least, microseconds(10));
  EXPECT_GT(most, microseconds(190));
  EXPECT_LT(most, microseconds(200));
}

TEST_F(SyncProducerTest, RunsInAWorld) {
  World world(1e6);
  world.bus().setAnalyser(true);
  std::vector<can::Frame> seen;
  world.bus().setMonitor([&](const can::Frame& frame, Time) { seen.push_back(frame); });
  SyncProducer in_world;
  in_world.connect(world.addParticipant("sync", in_world));
  SyncSchedule schedule;
  schedule.counter_overflow = 240;
  in_world.start(schedule, world.now());
  world.advance(world.now() + milliseconds(9));
  EXPECT_THAT(seen,
              ElementsAre(can::Frame(0x80, {1}), can::Frame(0x80, {2}), can::Frame(0x80, {3})));
}

/// Is due at 2 ms and every 3 ms from then on.
struct Bell final : Timed {
  void tick(Time now) override {
    rang.push_back(now);
    due += milliseconds(3);
  }
  Time nextDeadline() const override { return due; }
  Time due{milliseconds(2)};
  std::vector<Time> rang;
};

TEST(WorldTime, TicksWhatHasNoPortOfItWhenThatIsDue) {
  World world(1e6);
  Bell bell;
  world.add(bell);
  EXPECT_EQ(world.nextEvent(), Time(milliseconds(2)));
  world.advance(Time(milliseconds(8)));
  EXPECT_THAT(bell.rang,
              ElementsAre(Time(milliseconds(2)), Time(milliseconds(5)), Time(milliseconds(8))));
}

}  // namespace
}  // namespace cia402::sim
