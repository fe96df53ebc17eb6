// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Requests of a boot take turns with those of other nodes; nothing else waits for a turn.
#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::kAskDeviceType;
using test::Lines;

class BootTurnsTest : public test::NodeFixture {
 protected:
  void create() { node.emplace(config, master, peer, &turns); }
  /// A person reads the statusword. @return whether that leaves at once.
  bool asksAtOnce() {
    peer.take();
    node->sdo().upload({0x6041, 0});
    node->tick(now);
    const Lines sent = peer.take();
    return std::find(sent.begin(), sent.end(), "603 40 41 60 00 00 00 00 00") != sent.end();
  }

  SdoPacer turns{100.0};  // bit/s: a turn is 2.7 s long
};

TEST_F(BootTurnsTest, a_request_waits_for_its_turn) {
  turns.turn(now);  // of another node
  create();
  node->boot(now, false);
  EXPECT_EQ(peer.take(), Lines{"000 80 03"});
  EXPECT_EQ(node->nextDeadline(), now + milliseconds(2700));
  pass(milliseconds(2699));
  EXPECT_FALSE(sentLine(kAskDeviceType));
  pass(milliseconds(1));
  EXPECT_TRUE(sentLine(kAskDeviceType));
}

TEST_F(BootTurnsTest, a_node_that_is_taken_out_waits_for_no_turn_any_more) {
  turns.turn(now);
  create();
  node->boot(now, false);
  node->command(NmtCommand::enter_pre_operational, now);
  EXPECT_EQ(node->bootStep(), "not running");
  EXPECT_TRUE(asksAtOnce());
}

TEST_F(BootTurnsTest, a_boot_that_failed_waits_for_no_turn_any_more) {
  config.boot.retries = 0;
  turns.turn(now);
  create();
  node->boot(now, false);
  pass(milliseconds(30));
  for (int i = 0; i <= 10; ++i) {
    hear("703 04");  // stopped, and stays so
    if (i < 10) pass(milliseconds(100));
  }
  ASSERT_EQ(node->health(), Health::failed) << node->bootStep();
  hear("703 7F");
  EXPECT_TRUE(asksAtOnce());
}

}  // namespace
}  // namespace cia402::canopen
