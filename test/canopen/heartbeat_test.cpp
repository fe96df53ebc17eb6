// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/nmt/heartbeat.h"

#include <gtest/gtest.h>

#include "canopen/scripted_peer.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using Lines = std::vector<std::string>;

constexpr Time at(int ms) { return Time(milliseconds(ms)); }

TEST(HeartbeatConsumer, expires_a_time_out_after_the_last_heartbeat) {
  HeartbeatConsumer consumer(milliseconds(300));
  consumer.arm(at(0));
  EXPECT_EQ(consumer.deadline(), at(300)) << "the first one may fail to come, too";
  EXPECT_FALSE(consumer.expired(at(299)));
  consumer.heard(at(299));
  EXPECT_FALSE(consumer.expired(at(598)));
  EXPECT_TRUE(consumer.expired(at(599)));
  EXPECT_EQ(consumer.deadline(), at(599));
}

TEST(HeartbeatConsumer, is_started_by_the_first_heartbeat_once_allowed) {
  HeartbeatConsumer consumer(milliseconds(300));
  consumer.heard(at(0));
  EXPECT_FALSE(consumer.armed());
  consumer.allow();
  EXPECT_FALSE(consumer.armed());
  consumer.heard(at(10));
  EXPECT_EQ(consumer.deadline(), at(310));
}

TEST(HeartbeatConsumer, waits_for_nothing_when_disarmed) {
  HeartbeatConsumer consumer(milliseconds(300));
  consumer.arm(at(0));
  consumer.disarm();
  consumer.heard(at(1));
  EXPECT_EQ(consumer.deadline(), kNever);
  EXPECT_FALSE(consumer.expired(at(100000)));
}

TEST(HeartbeatProducer, says_boot_up_then_operational_every_period) {
  test::ScriptedPeer bus;
  HeartbeatProducer producer(127, milliseconds(100));
  producer.start(bus, at(0));
  EXPECT_EQ(bus.take(), (Lines{"77F 00", "77F 05"}));
  producer.tick(bus, at(99));
  EXPECT_EQ(bus.take(), Lines{});
  producer.tick(bus, at(103));
  EXPECT_EQ(bus.take(), Lines{"77F 05"});
  EXPECT_EQ(producer.deadline(), at(200));  // a late call does not shift the beat
}

TEST(HeartbeatProducer, woken_very_late_sends_one_heartbeat_not_a_burst) {
  test::ScriptedPeer bus;
  HeartbeatProducer producer(1, milliseconds(100));
  producer.start(bus, at(0));
  bus.take();
  producer.tick(bus, at(750));
  producer.tick(bus, at(751));
  EXPECT_EQ(bus.take(), Lines{"701 05"});
  EXPECT_EQ(producer.deadline(), at(850));
}

TEST(HeartbeatProducer, with_period_zero_sends_the_boot_up_only) {
  test::ScriptedPeer bus;
  HeartbeatProducer producer(127, Duration::zero());
  producer.start(bus, at(0));
  producer.tick(bus, at(100000));
  EXPECT_EQ(bus.take(), Lines{"77F 00"});
  EXPECT_EQ(producer.deadline(), kNever);
}

}  // namespace
}  // namespace cia402::canopen
