// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::kAskDeviceType;
using test::kAskVendor;
using test::Lines;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

const char kPreOperational[] = "000 80 03";
const char kReset[] = "000 82 03";

/// A drive that is in the NMT state stopped: it sends heartbeats and answers no SDO.
class BootWakeTest : public test::NodeFixture {
 protected:
  void beginStopped() {
    peer.forget(kAskDeviceType);
    boot(false);
    peer.take();
  }
  void wake() {
    peer.on(kAskDeviceType, "583 43 00 10 00 92 01 02 00");
    peer.on("603 40 18 10 00 00 00 00 00", "583 4F 18 10 00 04 00 00 00");
  }
  int count(const char* line) {
    const Lines sent = peer.take();
    return static_cast<int>(std::count(sent.begin(), sent.end(), line));
  }
};

TEST_F(BootWakeTest,
       a_heartbeat_that_says_stopped_brings_the_command_again_at_once_and_repeatedly) {
  beginStopped();
  pass(milliseconds(30));
  hear("703 04");
  EXPECT_THAT(peer.take(), Contains(kPreOperational));
  EXPECT_EQ(node->bootStep(), "waiting for the drive to leave the NMT state stopped");
  std::vector<int> at;
  for (int ms = 1; ms <= 170; ++ms) {
    pass(milliseconds(1));
    if (count(kPreOperational) > 0) at.push_back(ms);
    if (ms == 100) hear("703 04");
  }
  EXPECT_THAT(at, ElementsAre(20, 40, 60, 160));
}

TEST_F(BootWakeTest, nothing_is_asked_by_sdo_before_it_has_left_that_state) {
  beginStopped();
  pass(milliseconds(30));
  hear("703 04");
  peer.take();
  for (int i = 0; i < 9; ++i) {
    pass(milliseconds(100));
    hear("703 04");
  }
  EXPECT_THAT(peer.take(), Each(kPreOperational));
  wake();
  hear("703 7F");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(BootWakeTest, one_that_stays_stopped_is_told_as_that_with_the_remedy) {
  beginStopped();
  pass(milliseconds(30));
  for (int i = 0; i <= 10; ++i) {
    hear("703 04");
    if (i < 10) pass(milliseconds(100));
  }
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_EQ(
      node->problem(),
      "shoulder (node 3): boot failed: it says that it is stopped (NMT state), still after 13 "
      "commands to enter pre-operational within 1 s, and a stopped drive answers no SDO; look "
      "for another NMT master that stops it, and whether the drive hears this one (wiring); "
      "then switch it off and on, or recover; it is tried again in 1 s (attempt 2 of 3)");
}

TEST_F(BootWakeTest, a_reset_that_was_lost_is_given_again_where_the_heartbeat_shows_it) {
  peer.forget(kReset);
  boot();
  ASSERT_EQ(peer.take(), Lines{kReset});
  pass(milliseconds(40));
  hear("703 04");  // may have left before the reset
  EXPECT_THAT(peer.take(), IsEmpty());
  pass(milliseconds(60));
  peer.on(kReset, "703 00");
  hear("703 04");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_EQ(peer.take()[0], kReset);
}

TEST_F(BootWakeTest, the_reset_that_is_given_again_is_the_one_that_was_asked_for) {
  create();
  node->command(NmtCommand::reset_node, now);
  pass(milliseconds(100));
  hear("703 05");
  EXPECT_EQ(peer.take(), (Lines{"000 81 03", "000 81 03"}));
}

TEST_F(BootWakeTest, one_that_takes_no_reset_is_told_three_times_more_and_woken_then) {
  peer.forget(kReset);
  boot();
  for (int i = 0; i < 3; ++i) {
    pass(milliseconds(100));
    hear("703 04");
  }
  EXPECT_EQ(count(kReset), 4);
  pass(milliseconds(100));
  hear("703 04");
  EXPECT_EQ(peer.take(), Lines{kPreOperational});
  hear("703 7F");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(BootWakeTest, without_a_heartbeat_the_command_comes_with_each_question) {
  beginStopped();
  wake();
  peer.forget(kAskDeviceType);
  pass(milliseconds(500));
  EXPECT_THAT(peer.take(), Contains(kPreOperational));
  pass(milliseconds(500));
  EXPECT_THAT(peer.take(), Contains(kPreOperational));
}

TEST_F(BootWakeTest, one_that_is_stopped_while_it_is_configured_begins_again) {
  peer.forget(kAskVendor);
  boot();
  ASSERT_EQ(node->bootStep(), "reading 1018:01 vendor id");
  pass(milliseconds(100));
  peer.take();
  hear("703 04");
  EXPECT_THAT(peer.take(), Contains(kPreOperational));
  peer.on(kAskVendor, "583 43 18 10 01 CD AB 00 00");
  hear("703 7F");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(peer.take(), Contains(kAskDeviceType));
}

TEST_F(BootWakeTest, one_that_is_still_operational_is_made_pre_operational_again) {
  peer.forget(kAskVendor);
  boot(false);
  pass(milliseconds(100));
  peer.take();
  hear("703 05");
  EXPECT_EQ(peer.take(), Lines{kPreOperational});
  pass(milliseconds(10));
  hear("703 7F");
  EXPECT_THAT(peer.take(), Not(Contains(kPreOperational)));
}

TEST_F(BootWakeTest, a_heartbeat_that_was_on_its_way_when_it_was_commanded_tells_nothing) {
  peer.forget(kAskVendor);
  boot(false);
  pass(milliseconds(100));
  peer.take();
  hear("703 05");
  ASSERT_EQ(peer.take(), Lines{kPreOperational});
  pass(milliseconds(19));
  hear("703 05");
  EXPECT_THAT(peer.take(), Not(Contains(kPreOperational)));
  pass(milliseconds(1));
  hear("703 05");
  EXPECT_EQ(peer.take(), Lines{kPreOperational});
}

TEST_F(BootWakeTest, one_that_took_no_notice_of_the_reset_is_not_reset_while_it_is_configured) {
  peer.forget(kReset);
  peer.forget(kAskVendor);
  boot();
  pass(milliseconds(1250));  // no boot-up message, but it answers
  ASSERT_EQ(node->bootStep(), "reading 1018:01 vendor id");
  pass(milliseconds(100));
  peer.take();
  hear("703 05");
  EXPECT_EQ(peer.take(), Lines{kPreOperational});
}

TEST_F(BootWakeTest, one_that_says_operational_after_all_is_commanded_and_asked) {
  beginStopped();
  pass(milliseconds(30));
  hear("703 04");
  pass(milliseconds(85));  // 25 ms after the last command
  peer.take();
  wake();
  hear("703 05");
  const Lines sent = peer.take();
  ASSERT_GE(sent.size(), 2U);
  EXPECT_EQ(sent[0], kPreOperational);
  EXPECT_EQ(sent.back(), "000 01 03") << "it was asked at once, and configured";
}

TEST_F(BootWakeTest, one_that_falls_silent_is_asked_after_half_a_second) {
  beginStopped();
  pass(milliseconds(30));
  hear("703 04");
  pass(milliseconds(499));
  EXPECT_THAT(peer.take(), Not(Contains("603 40 18 10 00 00 00 00 00")));
  pass(milliseconds(101));  // with the next command at the latest
  EXPECT_THAT(peer.take(), Contains("603 40 18 10 00 00 00 00 00"));
}

TEST_F(BootWakeTest, one_that_said_stopped_once_and_no_more_is_told_with_that) {
  beginStopped();
  pass(milliseconds(30));
  hear("703 04");
  pass(seconds(6));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), ::testing::HasSubstr("it says that it is stopped (NMT state)"));
}

}  // namespace
}  // namespace cia402::canopen
