// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/bus_loop.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;

/// An interface with frames of nobody in its queue.
class Queue : public can::Interface {
 public:
  bool send(const can::Frame& sent) override {
    syncs += sent.id == 0x080 ? 1 : 0;
    return true;
  }
  std::optional<can::ReceivedFrame> receive(Time now) override {
    if (waiting == 0) return std::nullopt;
    --waiting;
    return can::ReceivedFrame{frame, std::min(now, stamp) + ahead};
  }
  void maintain(Time now) override { maintained = now; }
  int fd() const override { return -1; }
  can::BusState state() const override { return now_is; }
  const can::BusCounters& counters() const override { return counted; }
  std::string describe() const override { return "can0"; }

  long waiting = 0;
  can::Frame frame{0x7A0, {}};
  Time stamp = Time::max();  ///< of the frames, at the latest
  Duration ahead{};          ///< of the frames: they are stamped so much later
  int syncs = 0;
  Time maintained{};
  can::BusState now_is = can::BusState::error_active;
  can::BusCounters counted;
};

class BusLoopTest : public testing::Test, protected EventSink {
 protected:
  void onEvent(const Event&) override {}
  void onEmergency(const EmergencyEvent&) override {}
  void run(Duration duration) {
    for (const Time end = now + duration; now < end; now += 100us) loop.step(now);
  }
  Time lastCycle() const { return loop.network().cycle().lastCycle(); }

  config::RobotConfig robot = test::testRobot();
  Queue queue;
  BusLoop loop{robot, test::masterOf(robot), queue, *this};
  Time now{1s};
};

TEST_F(BusLoopTest, SleepsUntilTheRobotHasToDoSomething) {
  run(100ms);
  EXPECT_EQ(loop.nextDeadline(), loop.network().nextDeadline());
}

TEST_F(BusLoopTest, IsDueAtOnceWhileFramesWait) {
  run(101ms);
  queue.waiting = 300;
  loop.step(now);
  EXPECT_EQ(queue.waiting, 44);
  ASSERT_GT(loop.network().nextDeadline(), now);
  EXPECT_LE(loop.nextDeadline(), now);
  loop.step(now);
  EXPECT_EQ(queue.waiting, 0);
  EXPECT_GT(loop.nextDeadline(), now);
}

TEST_F(BusLoopTest, ProducesSyncWhileItReadsButNoCycleBeforeItHasReadThePast) {
  run(101ms);  // the cycle is due a millisecond later
  const Time before = lastCycle();
  const int syncs = queue.syncs;
  now += 100ms;  // a stall
  queue.stamp = now;
  queue.waiting = 300;
  loop.step(now);
  EXPECT_EQ(queue.syncs, syncs + 1);
  EXPECT_EQ(lastCycle(), before);
  loop.step(now);
  EXPECT_EQ(queue.syncs, syncs + 1);
  EXPECT_EQ(lastCycle(), now);
}

TEST_F(BusLoopTest, FramesThatCameAfterItsTimeKeepNoCycleFromIt) {
  run(101ms);
  now += 100ms;
  queue.ahead = 10us;  // they came while it read
  queue.waiting = 300;
  loop.step(now);
  EXPECT_EQ(queue.waiting, 44);
  EXPECT_EQ(lastCycle(), now);
}

TEST_F(BusLoopTest, RecordsTheAxesOfItsCycles) {
  run(100ms);
  EXPECT_FALSE(loop.recorder().copy(now).axes.empty());
}

TEST_F(BusLoopTest, LooksAfterItsInterfaceInEveryRound) {
  for (int i = 0; i < 3; ++i) {
    now += 1ms;
    loop.step(now);
    EXPECT_EQ(queue.maintained, now);
  }
}

// 1000 frames of 8 bytes have 47 + 64 bits each, of 10^6 in a second.
TEST_F(BusLoopTest, TellsTheLoadOfTheLastSecondWithAllThatItReceives) {
  queue.now_is = can::BusState::missing;  // it sends nothing
  loop.step(now);
  queue.frame = can::Frame(0x7A0, {0, 0, 0, 0, 0, 0, 0, 0});
  queue.waiting = 1000;
  run(1s);
  EXPECT_EQ(queue.waiting, 0);
  now += 1ms;
  loop.step(now);
  EXPECT_NEAR(loop.meter().load(), 0.111, 0.001);
}

TEST_F(BusLoopTest, GoesOnInAFloodThatComesFasterThanItIsRead) {
  run(100ms);
  const int syncs = queue.syncs;
  queue.waiting = 1'000'000'000;
  for (int i = 0; i < 50; ++i) {
    run(20ms);
    ASSERT_GT(lastCycle(), now - 2 * test::kPeriod);
  }
  EXPECT_NEAR(queue.syncs - syncs, 250, 2);
}

TEST_F(BusLoopTest, WhatItReceivesIsRecordedAndGoesToTheRobot) {
  run(10ms);
  queue.frame = can::Frame(0x702, {0x00});  // the elbow boots
  queue.stamp = now - 1ms;
  queue.waiting = 1;
  loop.step(now);
  EXPECT_EQ(loop.network().master().nodes()[1].bootUps(), 1u);
  const auto frames = loop.recorder().copy(now).frames;
  const auto heard = std::find_if(frames.begin(), frames.end(), [](const can::FrameRecord& record) {
    return record.direction() == can::Direction::received;
  });
  ASSERT_NE(heard, frames.end());
  EXPECT_EQ(heard->frame(), queue.frame);
  EXPECT_EQ(heard->stamp(), now - 1ms);
}

TEST_F(BusLoopTest, ABusOffIsATriggerOfTheRecorder) {
  robot.recorder.keep = 1;
  BusLoop recording(robot, test::masterOf(robot), queue, *this);
  recording.step(now);
  EXPECT_FALSE(recording.recorder().triggered());
  queue.now_is = can::BusState::bus_off;
  recording.step(now + 1ms);
  EXPECT_TRUE(recording.recorder().triggered());
  RecordingTrigger trigger;
  ASSERT_TRUE(recording.recorder().nextTrigger(trigger));
  EXPECT_EQ(trigger.kind, RecordingTrigger::Kind::bus_off);
  EXPECT_EQ(trigger.stamp, now + 1ms);
}

TEST_F(BusLoopTest, ABusOffThatIsOverBeforeTheNextRoundIsATriggerToo) {
  robot.recorder.keep = 1;
  BusLoop recording(robot, test::masterOf(robot), queue, *this);
  recording.step(now);
  ++queue.counted.bus_off_events;
  recording.step(now + 1ms);
  RecordingTrigger trigger;
  ASSERT_TRUE(recording.recorder().nextTrigger(trigger));
  EXPECT_EQ(trigger.kind, RecordingTrigger::Kind::bus_off);
  EXPECT_EQ(trigger.stamp, now + 1ms);
}

}  // namespace
}  // namespace cia402::bus
