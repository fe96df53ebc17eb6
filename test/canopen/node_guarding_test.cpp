// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/nmt/node_guarding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::Lines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(NodeGuardText, asks_with_a_remote_frame_for_one_byte) {
  const can::Frame request = NodeGuard::request(3);
  EXPECT_EQ(request.id, 0x703U);
  EXPECT_TRUE(request.remote);
  EXPECT_EQ(request.size, 1);
}

TEST(NodeGuard, gives_a_node_its_life_time_for_the_first_answer_too) {
  test::ScriptedPeer peer;
  const Time now(seconds(100));
  NodeGuard guard(3, milliseconds(100), 3);
  EXPECT_FALSE(guard.receive(0x05, now)) << "nobody has asked";
  EXPECT_FALSE(guard.answered());
  guard.start(true, peer, now);
  EXPECT_EQ(peer.take(), Lines{"703 R1"});
  EXPECT_EQ(guard.deadline(), now + milliseconds(100));
  EXPECT_FALSE(guard.expired(now + milliseconds(299)));
  EXPECT_TRUE(guard.expired(now + milliseconds(300)));
}

TEST(NodeGuard, tells_of_wrong_toggle_bits_since_the_last_right_answer_only) {
  test::ScriptedPeer peer;
  const Time now(seconds(100));
  NodeGuard guard(3, milliseconds(100), 3);
  guard.start(true, peer, now);
  EXPECT_FALSE(guard.receive(0x85, now)) << "the first one has toggle bit 0";
  EXPECT_THAT(guard.loss(), HasSubstr("the toggle bit of 1 answers did not alternate"));
  EXPECT_TRUE(guard.receive(0x05, now));
  EXPECT_EQ(guard.loss(), "no answer to node guarding for 0.3 s (asked every 0.1 s)");
}

/// A drive without heartbeat, guarded every 100 ms, lost after 300 ms.
class NodeGuarding : public test::NodeFixture {
 protected:
  NodeGuarding() {
    config.error_control = ErrorControl::guarding;
    peer.on("603 2B 17 10 00 00 00 00 00", "583 80 17 10 00 00 00 02 06");  // no 1017h
    peer.on("603 2B 0C 10 00 64 00 00 00", "583 60 0C 10 00 00 00 00 00");  // 100Ch = 100 ms
    peer.on("603 2F 0D 10 00 03 00 00 00", "583 60 0D 10 00 00 00 00 00");  // 100Dh = 3
    peer.forget("000 01 03");
    peer.on("703 R1", "703 7F");  // pre-operational, toggle 0
    peer.on("703 R1", "703 85");  // operational, toggle 1
    for (int i = 0; i < 100; ++i) {
      peer.on("703 R1", "703 05");
      peer.on("703 R1", "703 85");
    }
  }
  void bootReady() {
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem() << node->bootStep();
  }
  /// From now on the answers are these, the last one again and again.
  void answers(const Lines& lines) {
    peer.forget("703 R1");
    for (const std::string& line : lines) peer.on("703 R1", Lines{line});
  }
  unsigned requests() {
    const Lines sent = peer.take();
    return static_cast<unsigned>(std::count(sent.begin(), sent.end(), "703 R1"));
  }
};

TEST_F(NodeGuarding, is_set_up_in_the_drive_then_begins_before_the_start) {
  bootReady();
  const Lines sent = peer.take();
  const auto first = std::find(sent.begin(), sent.end(), "603 2B 17 10 00 00 00 00 00");
  ASSERT_NE(first, sent.end());
  EXPECT_EQ(Lines(first, first + 3),
            (Lines{"603 2B 17 10 00 00 00 00 00", "603 2B 0C 10 00 64 00 00 00",
                   "603 2F 0D 10 00 03 00 00 00"}));
  EXPECT_EQ(std::count(sent.begin(), sent.end(), "703 R1"), 2);
  EXPECT_EQ(sent.back(), "703 R1") << "asked at once whether it is operational";
  EXPECT_THAT(node->notes(), IsEmpty());
  EXPECT_FALSE(sentLine("603 23 16 10 01 2C 01 7F 00")) << "heartbeats are not for it";
  EXPECT_EQ(node->supervision().kind, ErrorControl::guarding);
  EXPECT_TRUE(node->supervision().watched);
  EXPECT_TRUE(node->supervision().watches_master);
}

TEST_F(NodeGuarding, asks_every_guard_time_as_long_as_it_is_answered) {
  bootReady();
  requests();
  pass(milliseconds(99));
  EXPECT_EQ(requests(), 0U);
  pass(milliseconds(1));
  EXPECT_EQ(requests(), 1U);
  pass(seconds(5));
  EXPECT_EQ(requests(), 50U);
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(node->nmtState(), NmtState::operational);
}

TEST_F(NodeGuarding, a_node_that_answers_no_more_is_lost_after_its_life_time) {
  bootReady();
  peer.take();
  peer.forget("703 R1");
  pass(milliseconds(299));
  EXPECT_EQ(node->health(), Health::ready);
  pass(milliseconds(1));
  EXPECT_EQ(node->health(), Health::lost);
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): no answer to node guarding for 0.3 s (asked every 0.1 s): check "
            "power and cable; it is configured again when it is back");
  EXPECT_TRUE(sentLine("000 02 03"));
}

TEST_F(NodeGuarding, a_node_that_heard_the_stop_after_its_loss_is_found_by_a_remote_frame) {
  bootReady();
  peer.forget("703 R1");
  pass(milliseconds(300));
  ASSERT_EQ(node->health(), Health::lost);
  peer.forget("603 40 00 10 00 00 00 00 00");  // stopped: no SDO, and nothing said unasked
  peer.take();
  pass(seconds(3));
  EXPECT_EQ(node->health(), Health::lost);
  EXPECT_GE(requests(), 1U);
  answers({"703 84"});  // stopped, toggle bit 1
  for (int i = 0; i < 300 && node->health() == Health::lost; ++i) pass(milliseconds(100));
  EXPECT_EQ(node->health(), Health::booting) << node->problem();
}

TEST_F(NodeGuarding, a_toggle_bit_that_stands_still_is_no_answer) {
  bootReady();
  answers({"703 05"});  // right once, then always the same
  pass(milliseconds(399));
  EXPECT_EQ(node->health(), Health::ready);
  pass(milliseconds(1));
  EXPECT_EQ(node->health(), Health::lost);
  EXPECT_THAT(node->problem(), HasSubstr("no valid answer to node guarding for 0.3 s (asked every "
                                         "0.1 s): the toggle bit of 2 answers did not alternate; "
                                         "look for a second device with this node-ID"));
}

TEST_F(NodeGuarding, one_lost_request_or_answer_does_no_harm) {
  bootReady();
  peer.forget("703 R1");
  pass(milliseconds(150));  // asked once in vain: the drive did not toggle
  answers({"703 05", "703 85", "703 85", "703 05", "703 85", "703 05", "703 85"});
  pass(milliseconds(700));
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(NodeGuarding, an_answer_that_was_lost_lets_the_next_one_seem_wrong_only_once) {
  bootReady();                                        // last answer: toggle 1
  answers({"703 85", "703 05", "703 85", "703 05"});  // that with toggle 0 was lost
  pass(milliseconds(400));
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(NodeGuarding, after_a_boot_up_the_first_answer_must_have_toggle_bit_0) {
  answers({"703 FF"});  // pre-operational, but toggle bit 1 from the beginning
  boot();
  pass(milliseconds(300));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("boot failed: no valid answer to node guarding"));
}

TEST_F(NodeGuarding, without_a_reset_the_toggle_bit_may_begin_either_way) {
  answers({"703 FF", "703 05", "703 85"});
  boot(false);
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(NodeGuarding, another_state_than_expected_is_told_and_set_right) {
  bootReady();
  peer.forget(test::request(3, "40 00 10 00 00 00 00 00"));
  answers({"703 04"});
  pass(milliseconds(100));
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_THAT(node->problem(), HasSubstr("became stopped without our command"));
}

TEST_F(NodeGuarding, a_drive_that_does_not_take_the_life_time_cannot_notice_a_dead_master) {
  peer.replace("603 2B 0C 10 00 64 00 00 00", "583 80 0C 10 00 00 00 02 06");
  peer.replace("603 2F 0D 10 00 03 00 00 00", "583 80 0D 10 00 00 00 02 06");
  bootReady();
  EXPECT_THAT(node->notes(),
              ElementsAre("cannot notice a dead master: writing 0x0064 to 100C:00 guard time: the "
                          "drive refused: 0x06020000 (object does not exist in the object "
                          "dictionary)"));
  EXPECT_TRUE(node->supervision().watched);
  EXPECT_FALSE(node->supervision().watches_master);
}

TEST_F(NodeGuarding, a_drive_that_answers_sdo_but_no_guarding_fails_with_a_remedy) {
  peer.forget("703 R1");
  boot();
  pass(milliseconds(300));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): boot failed: no answer to node guarding for 0.3 s (asked every 0.1 "
            "s); if the drive has no node guarding, choose another `error_control`; it is tried "
            "again in 1 s (attempt 2 of 3)");
}

TEST_F(NodeGuarding, a_lost_node_is_looked_for_and_booted_again) {
  bootReady();
  peer.forget("703 R1");
  const std::string ask = test::request(3, "40 00 10 00 00 00 00 00");
  peer.forget(ask);
  pass(milliseconds(300));
  ASSERT_EQ(node->health(), Health::lost);
  peer.take();
  pass(milliseconds(3000));
  Lines sent = peer.take();
  sent.erase(std::remove(sent.begin(), sent.end(), "000 02 03"), sent.end());  // again and again
  EXPECT_EQ(sent, (Lines{"000 80 03", ask, "703 R1"}));
  EXPECT_EQ(node->bootStep(), "looked for 1 times, again every 2 s");
  peer.on(ask, "583 43 00 10 00 92 01 02 00");
  answers({"703 7F", "703 85", "703 05"});
  pass(milliseconds(4500));
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(NodeGuarding, one_that_says_stopped_is_woken_at_once_and_asked_each_time) {
  const std::string ask = test::request(3, "40 00 10 00 00 00 00 00");
  peer.forget(ask);
  boot(false);
  answers({"703 04", "703 84", "703 04", "703 84", "703 FF", "703 05", "703 85"});
  peer.take();
  pass(milliseconds(500));  // no answer by SDO: it is commanded, and asked for its state
  Lines sent = peer.take();
  const auto of_sdo = [](const std::string& line) { return line.rfind("603 ", 0) == 0; };
  sent.erase(std::remove_if(sent.begin(), sent.end(), of_sdo), sent.end());
  EXPECT_THAT(sent, ElementsAre("000 80 03", "703 R1", "000 80 03", "703 R1"));
  peer.on(ask, "583 43 00 10 00 92 01 02 00");
  for (int i = 0; i < 2; ++i) {
    pass(milliseconds(20));
    EXPECT_THAT(peer.take(), ElementsAre("000 80 03", "703 R1"));
  }
  pass(milliseconds(20));  // now it says pre-operational
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(NodeGuarding, no_request_leaves_while_the_node_is_not_there) {
  peer.forget("000 82 03");
  boot();
  pass(milliseconds(1200));
  EXPECT_EQ(requests(), 0U);
}

TEST_F(NodeGuarding, a_drive_without_life_time_factor_cannot_notice_a_dead_master_either) {
  peer.replace("603 2F 0D 10 00 03 00 00 00", "583 80 0D 10 00 00 00 02 06");
  bootReady();
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("cannot notice a dead master: writing 0x03 to "
                                                   "100D:00 life time factor")));
  EXPECT_TRUE(node->supervision().watched);
  EXPECT_FALSE(node->supervision().watches_master);
}

TEST_F(NodeGuarding, a_heartbeat_that_stays_on_beside_it_is_told) {
  peer.replace("603 2B 17 10 00 00 00 00 00", "583 80 17 10 00 02 00 01 06");  // read-only
  bootReady();
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("its heartbeat could not be switched off for "
                                                   "node guarding: writing 0x0000 to 1017:00")));
}

TEST_F(NodeGuarding, waits_for_the_answer_that_says_operational) {
  answers({"703 7F"});
  boot();
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_EQ(node->bootStep(), "waiting for an answer to guarding that says operational");
}

TEST_F(NodeGuarding, a_node_that_answered_and_falls_silent_while_it_boots_is_lost) {
  peer.forget("603 40 00 16 00 00 00 00 00");
  answers({"703 7F"});
  boot();
  ASSERT_EQ(node->health(), Health::booting);
  peer.forget("703 R1");
  pass(milliseconds(300));
  EXPECT_EQ(node->health(), Health::lost);
  EXPECT_THAT(node->problem(), HasSubstr("no answer to node guarding for 0.3 s"));
}

TEST_F(NodeGuarding, answers_of_before_a_reboot_tell_nothing_of_the_drive_that_boots) {
  bootReady();
  peer.forget("703 R1");
  hear("703 00");
  pass(milliseconds(300));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("if the drive has no node guarding"));
}

TEST_F(NodeGuarding, a_node_whose_boot_failed_is_guarded_no_more) {
  peer.replace("603 40 00 18 01 00 00 00 00", "583 80 00 18 01 00 00 02 06");
  boot();
  ASSERT_EQ(node->health(), Health::failed);
  requests();
  pass(seconds(1));
  EXPECT_EQ(requests(), 0U);
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("1800:01"));
}

}  // namespace
}  // namespace cia402::canopen
