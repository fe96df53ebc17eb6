// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A block download sends as much as the interface takes, and no more than may wait in its queue.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "can/pacer.h"
#include "canopen/sdo_client_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;

constexpr char kInitiated[] = "581 A4 50 1F 01 7F 00 00 00";  // 127 segments at a time

SdoOptions block() {
  SdoOptions result;
  result.block = SdoOptions::Block::always;
  return result;
}

TEST(SdoBlockPacing, feeds_the_wire_a_few_segments_at_a_time_and_each_time_when_it_said) {
  test::ScriptedPeer peer;
  can::Pacer pacer(peer, 1e6);
  SdoClient client(1, pacer, block(), {}, &pacer);
  Time now(std::chrono::seconds(1));
  pacer.setTime(now);
  const SdoTicket ticket = client.download({0x1F50, 1}, Bytes(889, 7));  // 127 segments
  client.tick(now);
  now += milliseconds(5);
  pacer.setTime(now);
  peer.take();
  client.receive(test::frame(kInitiated), now);
  std::size_t sent = peer.take().size();
  EXPECT_GE(sent, 1U);
  EXPECT_LE(sent, 5U) << "about four frames wait";
  while (sent < 127) {
    ASSERT_GT(client.nextDeadline(), now) << sent;
    ASSERT_LT(client.nextDeadline(), now + milliseconds(1)) << sent << ": the wire falls idle";
    now = client.nextDeadline();
    pacer.setTime(now);
    client.tick(now);
    const std::size_t more = peer.take().size();
    ASSERT_GE(more, 1U) << "woken in vain";
    ASSERT_LE(more, 5U);
    sent += more;
  }
  client.receive(test::frame("581 A2 7F 7F 00 00 00 00 00"), now);
  client.receive(test::frame("581 A1 00 00 00 00 00 00 00"), now);
  EXPECT_TRUE(ticket->ok()) << ticket->message();
}

/// An interface whose queue is full at times.
class FullQueue : public test::ScriptedPeer {
 public:
  bool send(const can::Frame& frame) override { return !full && ScriptedPeer::send(frame); }
  bool full = false;
};

TEST(SdoBlockPacing, goes_on_a_little_later_where_the_queue_of_the_interface_is_full) {
  FullQueue queue;
  SdoClient client(1, queue, block());
  Time now(std::chrono::seconds(1));
  client.download({0x1F50, 1}, Bytes(20, 7));
  client.tick(now);
  queue.take();
  queue.full = true;
  client.receive(test::frame(kInitiated), now);
  EXPECT_GT(client.nextDeadline(), now) << "not at once, again and again";
  EXPECT_LE(client.nextDeadline(), now + milliseconds(10));
  now = client.nextDeadline();
  client.tick(now);
  EXPECT_TRUE(queue.take().empty());
  queue.full = false;
  now = client.nextDeadline();
  client.tick(now);
  EXPECT_EQ(queue.take(),
            (std::vector<std::string>{"601 01 07 07 07 07 07 07 07", "601 02 07 07 07 07 07 07 07",
                                      "601 83 07 07 07 07 07 07 00"}));
}

/// A sub-block of 127 segments is under way on a bus of 10 kbit/s, where it takes about 1.7 s.
class SdoBlockOnASlowBus : public ::testing::Test {
 protected:
  SdoBlockOnASlowBus() {
    pacer.setTime(now);
    ticket = client.download({0x1F50, 1}, Bytes(910, 7));  // 130 segments
    client.tick(now);
    now += milliseconds(100);
    pacer.setTime(now);
    peer.take();
  }
  void receive(const char* line) {
    pacer.setTime(now);
    client.receive(test::frame(line), now);
  }
  /// Until so many segments were sent since the last call.
  void feed(std::size_t segments) {
    while (peer.sent.size() < segments && !ticket->done()) {
      now = client.nextDeadline();
      pacer.setTime(now);
      client.tick(now);
    }
    EXPECT_FALSE(ticket->done()) << ticket->message();
    peer.take();
  }

  test::ScriptedPeer peer;
  can::Pacer pacer{peer, 10e3};
  SdoClient client{1, pacer, block(), {}, &pacer};
  SdoTicket ticket;
  Time now{std::chrono::seconds(1)};
};

TEST_F(SdoBlockOnASlowBus, may_take_longer_than_the_server_has_for_an_answer) {
  const Time start = now;
  receive(kInitiated);
  feed(127);
  EXPECT_GT(now - start, std::chrono::seconds(1));
  receive("581 A2 7F 7F 00 00 00 00 00");
  feed(3);
  receive("581 A2 03 7F 00 00 00 00 00");
  receive("581 A1 00 00 00 00 00 00 00");
  EXPECT_TRUE(ticket->ok()) << ticket->message();
}

TEST_F(SdoBlockOnASlowBus, takes_no_notice_of_an_acknowledge_that_comes_twice_while_it_sends) {
  receive("581 A4 50 1F 01 0A 00 00 00");  // ten segments
  feed(10);
  receive("581 A2 0A 7F 00 00 00 00 00");
  receive("581 A2 0A 7F 00 00 00 00 00");
  EXPECT_FALSE(ticket->done()) << ticket->message();
  EXPECT_EQ(client.counters().stray_frames, 1U);
  feed(120);
  receive("581 A2 78 7F 00 00 00 00 00");
  receive("581 A1 00 00 00 00 00 00 00");
  EXPECT_TRUE(ticket->ok()) << ticket->message();
}

}  // namespace
}  // namespace cia402::canopen
