// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sync/time_producer.h"

#include <gtest/gtest.h>

#include "canopen/scripted_peer.h"

namespace cia402::canopen {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Lines = std::vector<std::string>;

std::string at(UnixTime time) {
  const auto frame = timeFrame(time);
  return frame ? test::text(*frame) : "nothing";
}

TEST(TimeFrame, counts_milliseconds_after_midnight_and_days_since_1984) {
  // 1984-01-01 00:00:00 UTC is 441763200 s after 1970.
  EXPECT_EQ(at(seconds(441763200)), "100 00 00 00 00 00 00");
  EXPECT_EQ(at(seconds(441763200) + milliseconds(1)), "100 01 00 00 00 00 00");
  // 86399999 ms = 0x05265BFF, the last of a day; 1984-01-02 is day 1.
  EXPECT_EQ(at(seconds(441763200 + 86400) + milliseconds(86399999)), "100 FF 5B 26 05 01 00");
  // 2026-11-21 14:30:11.250 UTC: 1795271411.25 s; 52211250 ms = 0x031CAE32, day 15665 = 0x3D31.
  EXPECT_EQ(at(seconds(1795271411) + milliseconds(250)), "100 32 AE 1C 03 31 3D");
}

TEST(TimeFrame, does_not_tell_what_it_cannot) {
  EXPECT_EQ(at(seconds(441763199)), "nothing");
  EXPECT_EQ(at(UnixTime::zero()), "nothing") << "a clock that was never set";
  EXPECT_EQ(at(seconds(441763200) + hours(24) * 65535), "100 00 00 00 00 FF FF");
  EXPECT_EQ(at(seconds(441763200) + hours(24) * 65536), "nothing");
}

TEST(TimeProducer, sends_at_its_interval_once_it_knows_the_time) {
  test::ScriptedPeer peer;
  TimeProducer producer(seconds(1));
  Time now(seconds(100));
  EXPECT_EQ(producer.deadline(), kNever);
  producer.start(now);
  producer.tick(peer, now);
  EXPECT_EQ(peer.take(), Lines{}) << "nobody has told the time";
  producer.setWallTime(seconds(441763200), now);
  EXPECT_EQ(producer.deadline(), now + seconds(1));
  producer.tick(peer, now + milliseconds(999));
  EXPECT_EQ(peer.take(), Lines{});
  producer.tick(peer, now + seconds(1));
  EXPECT_EQ(peer.take(), Lines{"100 E8 03 00 00 00 00"});  // 1000 ms
  producer.tick(peer, now + seconds(5));                   // woken late
  EXPECT_EQ(peer.take(), Lines{"100 88 13 00 00 00 00"});
  EXPECT_EQ(producer.deadline(), now + seconds(6));
}

TEST(TimeProducer, woken_late_keeps_its_beat_and_sends_no_second_one) {
  test::ScriptedPeer peer;
  TimeProducer producer(seconds(1));
  const Time now(seconds(100));
  producer.setWallTime(seconds(441763200), now);
  producer.start(now);
  producer.tick(peer, now + milliseconds(5));
  EXPECT_EQ(producer.deadline(), now + seconds(1));
  producer.tick(peer, now + seconds(2));  // by a whole interval
  EXPECT_EQ(producer.deadline(), now + seconds(3));
  EXPECT_EQ(peer.take(), (Lines{"100 05 00 00 00 00 00", "100 D0 07 00 00 00 00"}));
}

TEST(TimeProducer, takes_the_clock_of_the_process_for_no_wall_clock) {
  test::ScriptedPeer peer;
  TimeProducer producer(seconds(1));
  const Time now(seconds(500000000));  // up for sixteen years
  producer.start(now);
  producer.tick(peer, now);
  EXPECT_EQ(peer.take(), Lines{});
}

TEST(TimeProducer, is_silent_unless_configured) {
  TimeProducer producer{Duration::zero()};
  producer.start(Time(seconds(1)));
  EXPECT_EQ(producer.deadline(), kNever);
  EXPECT_FALSE(producer.enabled());
}

}  // namespace
}  // namespace cia402::canopen
