// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the master sends and hears counts when others want to send.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "canopen/master.h"
#include "canopen/scripted_drive.h"

namespace cia402::canopen {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// Nodes 3 and 5 at 1 Mbit/s: a bit is a microsecond, a frame of eight bytes 135 at most.
class MasterPacing : public ::testing::Test {
 protected:
  MasterPacing() {
    config.bitrate = 1e6;
    config.heartbeat = Duration::zero();
    config.nodes = {test::servoConfig(3, "shoulder"), test::servoConfig(5, "elbow")};
    test::addServo(peer, 3);
    test::addServo(peer, 5);
    master.emplace(config, peer);
  }
  void hear(const std::string& text) {
    master->receive(test::frame(text), now, now);
    settle();
  }
  void settle() {
    peer.deliver([this](const can::Frame& received) { master->receive(received, now, now); });
  }
  void pass(Duration duration) {
    const Time end = now + duration;
    while (master->nextDeadline() <= end) {
      now = std::max(now, master->nextDeadline());
      master->tick(now);
      settle();
    }
    now = end;
  }
  std::ptrdiff_t count(const std::string& beginning) {
    const auto lines = peer.take();
    return std::count_if(lines.begin(), lines.end(),
                         [&](const std::string& line) { return line.rfind(beginning, 0) == 0; });
  }
  /// A block download to node 5 of which the server takes 127 segments at once. @return how many of
  /// them leave at once.
  std::ptrdiff_t beginDownload() {
    SdoOptions block;
    block.block = SdoOptions::Block::always;
    master->find(5)->sdo().download({0x1F50, 1}, Bytes(889, 7), "program", block);
    master->tick(now);
    EXPECT_EQ(count("605 C6 50 1F 01 79 03 00 00"), 1);
    hear("585 A4 50 1F 01 7F 00 00 00");
    return count("605 ");
  }

  test::ScriptedPeer peer;
  MasterConfig config;
  std::optional<Master> master;
  Time now{seconds(1)};
};

TEST_F(MasterPacing, a_long_transfer_leaves_piece_by_piece) {
  EXPECT_GE(beginDownload(), 1);
  const Time next = master->nextDeadline();
  EXPECT_GT(next, now);
  pass(next - now);
  EXPECT_GE(count("605 "), 1);
}

TEST_F(MasterPacing, a_frame_of_another_holds_a_long_transfer_up_as_long_as_it_takes) {
  beginDownload();
  const Time next = master->nextDeadline();
  hear("7E4 00 00 00 00 00 00 00 00");  // while segments wait: those leave later by its 135 bits
  now = next;
  master->tick(now);
  EXPECT_EQ(count("605 "), 0);
  EXPECT_EQ(master->nextDeadline(), next + microseconds(135));
  pass(microseconds(135));
  EXPECT_GE(count("605 "), 1);
}

TEST_F(MasterPacing, segments_that_leave_with_an_answer_count_from_then_on) {
  SdoOptions block;
  block.block = SdoOptions::Block::always;
  master->find(5)->sdo().download({0x1F50, 1}, Bytes(889, 7), "program", block);
  master->tick(now);
  peer.take();
  now += milliseconds(400);  // a slow server
  hear("585 A4 50 1F 01 7F 00 00 00");
  EXPECT_LE(count("605 "), 5) << "about four frames wait";
}

TEST_F(MasterPacing, segments_that_leave_late_count_from_then_on) {
  beginDownload();
  now = master->nextDeadline() + milliseconds(5);  // the thread was held up
  master->tick(now);
  EXPECT_LE(count("605 "), 5);
}

TEST_F(MasterPacing, nothing_waits_when_the_next_sync_is_due) {
  config.sync_period = milliseconds(1);
  master.emplace(config, peer);
  master->sendSync(now);
  const Time next_sync = now + milliseconds(1);
  std::ptrdiff_t sent = beginDownload();
  while (master->nextDeadline() < next_sync) {
    pass(master->nextDeadline() - now);
    sent += count("605 ");
  }
  // SYNC, request and answer take more than 250 us, a segment of eight bytes at least 108.
  EXPECT_LE(sent, 6);
  EXPECT_GE(sent, 3);
  EXPECT_EQ(master->nextDeadline(), next_sync);
}

TEST_F(MasterPacing, the_commands_of_the_start_hold_a_long_transfer_up) {
  peer.forget("000 82 03");
  peer.forget("000 82 05");
  master->start(now);
  EXPECT_EQ(beginDownload(), 0);
}

TEST_F(MasterPacing, rpdos_that_wait_hold_a_long_transfer_up) {
  master->start(now, false);
  settle();
  pass(milliseconds(50));
  ASSERT_EQ(master->find(5)->health(), Health::ready) << master->find(5)->problem();
  peer.take();
  for (int i = 0; i < 5; ++i) master->sendRpdos(now);
  EXPECT_EQ(count("205 "), 5);
  EXPECT_EQ(beginDownload(), 0);
}

TEST_F(MasterPacing, commands_to_all_nodes_that_wait_hold_a_long_transfer_up) {
  for (int i = 0; i < 10; ++i) master->commandAll(NmtCommand::start, now);
  EXPECT_EQ(beginDownload(), 0) << "more than four frames' worth of bits wait already";
}

TEST_F(MasterPacing, syncs_that_wait_hold_a_long_transfer_up) {
  for (int i = 0; i < 20; ++i) master->sendSync(now);
  EXPECT_EQ(beginDownload(), 0);
}

TEST_F(MasterPacing, rpdos_push_the_requests_of_booting_nodes_back) {
  master->start(now, false);
  settle();
  pass(milliseconds(50));
  ASSERT_EQ(master->find(3)->health(), Health::ready) << master->find(3)->problem();
  ASSERT_EQ(master->find(5)->health(), Health::ready) << master->find(5)->problem();
  const std::string ask_type = "605 40 00 10 00 00 00 00 00";
  const std::string ask_vendor = "605 40 18 10 01 00 00 00 00";
  peer.forget(ask_type);
  peer.take();
  hear("705 00");
  ASSERT_EQ(count(ask_type), 1);
  master->sendRpdos(now);  // one, of node 3
  ASSERT_EQ(count("203 "), 1);
  hear("585 43 00 10 00 92 01 02 00");
  // Two frames of 135 us for request and answer, one for the RPDO.
  pass(microseconds(404));
  EXPECT_EQ(count(ask_vendor), 0);
  pass(microseconds(1));
  EXPECT_EQ(count(ask_vendor), 1);
}

TEST_F(MasterPacing, tpdos_push_the_requests_of_booting_nodes_back) {
  master->start(now, false);
  settle();
  pass(milliseconds(50));
  ASSERT_EQ(master->find(5)->health(), Health::ready) << master->find(5)->problem();
  const std::string ask_vendor = "605 40 18 10 01 00 00 00 00";
  peer.forget("605 40 00 10 00 00 00 00 00");
  hear("705 00");
  hear("183 37 02 2A 00 00 00");
  peer.take();
  hear("585 43 00 10 00 92 01 02 00");
  pass(microseconds(404));
  EXPECT_EQ(count(ask_vendor), 0);
  pass(microseconds(1));
  EXPECT_EQ(count(ask_vendor), 1);
}

}  // namespace
}  // namespace cia402::canopen
