// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node/node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::frame;
using test::kAskDeviceType;
using test::kControlword;
using test::kStatusword;
using test::kTarget;
using test::Lines;
using ::testing::HasSubstr;

class NodeTest : public test::NodeFixture {
 protected:
  void bootReady() {
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    peer.take();
  }
  void tpdo(const std::string& text) { node->receiveTpdo(0, frame(text), now); }
  fieldbus::ProcessValue statusword() {
    return node->image().input(node->image().inputSlot(kStatusword));
  }
  Lines rpdos() {
    peer.take();
    node->sendRpdos(now);
    return peer.take();
  }
  /// Heartbeats every 100 ms, the first one 100 ms from now.
  void beat(int times, const std::string& text = "703 05") {
    for (int i = 0; i < times; ++i) {
      pass(milliseconds(100));
      hear(text);
    }
  }
};

TEST_F(NodeTest, does_nothing_by_itself_before_the_first_boot) {
  create();
  EXPECT_EQ(node->health(), Health::absent);
  EXPECT_EQ(node->bootStep(), "not started");
  hear("703 00");
  hear("703 05");
  EXPECT_EQ(node->health(), Health::absent);
  EXPECT_EQ(node->bootUps(), 1U);
  EXPECT_EQ(node->nmtState(), NmtState::operational);
  EXPECT_TRUE(peer.take().empty());
}

TEST_F(NodeTest, sends_rpdos_only_when_ready_and_with_controlword_0_until_told_otherwise) {
  peer.forget("000 82 03");
  boot();
  EXPECT_EQ(rpdos(), Lines{});
  hear("703 00");
  EXPECT_EQ(rpdos(), Lines{"203 00 00 00 00 00 00"});
  node->image().setOutput(node->image().outputSlot(kControlword), 0x0006);
  node->image().setOutput(node->image().outputSlot(kTarget), 0x12345678);
  EXPECT_EQ(rpdos(), Lines{"203 06 00 78 56 34 12"});
  EXPECT_EQ(rpdos(), Lines{"203 06 00 78 56 34 12"});  // every cycle, changed or not
  EXPECT_EQ(node->image().sent(node->image().outputSlot(kControlword)), 3U);
}

TEST_F(NodeTest, believes_tpdos_only_after_it_has_started_the_node) {
  peer.forget("000 82 03");
  boot();
  tpdo("183 37 02 01 00 00 00");  // from a mapping of before the boot
  EXPECT_FALSE(statusword().valid);
  hear("703 00");
  tpdo("183 37 02 01 00 00 00");
  EXPECT_TRUE(statusword().valid);
  EXPECT_EQ(statusword().raw, 0x0237U);
}

TEST_F(NodeTest, stays_ready_while_heartbeats_come) {
  bootReady();
  beat(50);
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(node->lastHeartbeat(), now);
  EXPECT_TRUE(peer.take().empty());
}

TEST_F(NodeTest, is_lost_a_time_out_after_its_last_heartbeat) {
  bootReady();
  beat(3);
  tpdo("183 37 02 01 00 00 00");
  node->image().setOutput(node->image().outputSlot(kControlword), 0x000F);
  const SdoTicket ticket = node->sdo().upload(kStatusword);
  pass(milliseconds(299));
  EXPECT_EQ(node->health(), Health::ready);
  pass(milliseconds(1));
  EXPECT_EQ(node->health(), Health::lost);
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): no heartbeat for 0.3 s: check power and cable; it is configured "
            "again when it is back");
  EXPECT_FALSE(statusword().valid);
  tpdo("183 37 02 01 00 00 00");  // not believed before it is configured again
  EXPECT_FALSE(statusword().valid);
  EXPECT_EQ(ticket->failure(), SdoTransfer::Failure::cancelled);
  EXPECT_THAT(ticket->message(), HasSubstr("cancelled: the node is lost: no heartbeat for 0.3 s"));
  EXPECT_EQ(rpdos(), Lines{});
  EXPECT_EQ(node->image().output(node->image().outputSlot(kControlword)), 0U);
}

TEST_F(NodeTest, a_node_that_never_sends_a_heartbeat_after_being_ready_is_lost) {
  bootReady();
  pass(milliseconds(300));
  EXPECT_EQ(node->health(), Health::lost);
}

TEST_F(NodeTest, a_lost_node_boots_again_at_its_next_heartbeat) {
  bootReady();
  pass(seconds(1));
  ASSERT_EQ(node->health(), Health::lost);
  peer.take();
  hear("703 05");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(node->problem(), "");
  const Lines sent = peer.take();
  EXPECT_EQ(sent[0], "000 80 03");  // pre-operational, but no reset
  EXPECT_EQ(sent[1], kAskDeviceType);
  EXPECT_EQ(sent.back(), "000 01 03");
  EXPECT_EQ(rpdos(), Lines{"203 00 00 00 00 00 00"});
}

TEST_F(NodeTest, a_lost_node_boots_again_at_its_boot_up) {
  bootReady();
  pass(seconds(1));
  hear("703 00");
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(NodeTest, a_reboot_in_operation_voids_everything_and_boots_again_without_reset) {
  bootReady();
  tpdo("183 37 02 01 00 00 00");
  node->image().setOutput(node->image().outputSlot(kControlword), 0x000F);
  const SdoTicket ticket = node->sdo().upload(kStatusword);
  node->tick(now);
  peer.forget(kAskDeviceType);
  peer.take();
  hear("703 00");
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_THAT(node->problem(), HasSubstr("shoulder (node 3): rebooted by itself"));
  EXPECT_EQ(node->bootUps(), 2U);
  EXPECT_FALSE(statusword().valid);
  EXPECT_EQ(ticket->failure(), SdoTransfer::Failure::cancelled);
  EXPECT_EQ(node->image().output(node->image().outputSlot(kControlword)), 0U);
  EXPECT_EQ(rpdos(), Lines{});
  tpdo("183 37 02 01 00 00 00");
  EXPECT_FALSE(statusword().valid);
  hear("583 43 00 10 00 92 01 02 00");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_FALSE(sentLine("000 82 03"));
}

TEST_F(NodeTest, is_not_lost_while_it_boots_again_without_having_sent_a_heartbeat) {
  bootReady();
  peer.forget(kAskDeviceType);
  hear("703 00");
  pass(milliseconds(400));
  EXPECT_EQ(node->health(), Health::booting);
}

TEST_F(NodeTest, a_ready_node_that_becomes_pre_operational_by_itself_is_configured_again) {
  bootReady();
  peer.forget(kAskDeviceType);
  hear("703 7F");
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_THAT(node->problem(), HasSubstr("became pre-operational without our command"));
  hear("583 43 00 10 00 92 01 02 00");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(node->problem(), "");
}

// On a full bus a heartbeat, of low priority, may leave the drive long after the TPDO that was made
// after it.
TEST_F(NodeTest, a_heartbeat_of_before_its_start_may_come_after_the_tpdo_that_shows_it) {
  peer.forget("000 01 03");
  boot();
  tpdo("183 37 02 01 00 00 00");
  pass(milliseconds(0));
  ASSERT_EQ(node->health(), Health::ready);
  peer.take();
  hear("703 7F");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(peer.take(), Lines{});
  EXPECT_EQ(node->lastHeartbeat(), now);
  beat(1);
  EXPECT_EQ(node->nmtState(), NmtState::operational);
  peer.forget(kAskDeviceType);
  hear("703 7F");
  EXPECT_EQ(node->health(), Health::booting);
}

TEST_F(NodeTest, a_second_heartbeat_of_before_its_start_tells_that_it_is_not_operational) {
  peer.forget("000 01 03");
  boot();
  tpdo("183 37 02 01 00 00 00");
  pass(milliseconds(0));
  ASSERT_EQ(node->health(), Health::ready);
  peer.forget(kAskDeviceType);
  beat(2, "703 7F");
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_THAT(node->problem(), HasSubstr("became pre-operational without our command"));
}

TEST_F(NodeTest, a_ready_node_that_was_stopped_by_somebody_is_configured_again) {
  bootReady();
  hear("703 04");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_TRUE(sentLine("000 01 03"));
}

TEST_F(NodeTest, a_heartbeat_with_an_undefined_state_is_a_sign_of_life_and_nothing_else) {
  bootReady();
  beat(10, "703 42");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(node->nmtState(), NmtState::unknown);
}

TEST_F(NodeTest, our_own_command_out_of_operation_starts_no_boot) {
  bootReady();
  node->command(NmtCommand::enter_pre_operational, now);
  EXPECT_EQ(peer.take(), Lines{"000 80 03"});
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_EQ(rpdos(), Lines{});
  hear("703 7F");
  pass(seconds(1));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("NMT command 'enter pre-operational'"));
  node->boot(now, false);
  settle();
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(NodeTest, a_transfer_of_a_node_that_says_stopped_is_given_up_and_not_asked_again) {
  bootReady();
  node->command(NmtCommand::stop, now);
  const SdoTicket reading = node->sdo().upload({0x6065, 0}, "following error window");
  const SdoTicket waiting = node->sdo().upload({0x6066, 0});
  node->tick(now);
  ASSERT_EQ(peer.take(), (Lines{"000 02 03", "603 40 65 60 00 00 00 00 00"}));
  hear("703 04");
  EXPECT_EQ(peer.take(), Lines{"603 80 65 60 00 00 00 00 08"});  // general error: it may be heard
  for (const SdoTicket& ticket : {reading, waiting}) {
    ASSERT_TRUE(ticket->done());
    EXPECT_FALSE(ticket->ok());
    EXPECT_THAT(ticket->reason(), HasSubstr("a stopped drive answers no SDO; boot it (recover"));
  }
  pass(seconds(2));
  EXPECT_EQ(peer.take(), Lines{});
}

TEST_F(NodeTest, a_commanded_reset_leads_to_a_new_boot) {
  peer.on("000 81 03", "703 00");
  bootReady();
  node->command(NmtCommand::reset_node, now);
  EXPECT_EQ(node->health(), Health::booting);
  settle();
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(NodeTest, a_failed_node_tries_again_when_it_was_switched_off_and_on) {
  peer.replace("603 40 18 10 01 00 00 00 00", "583 80 18 10 01 00 00 00 08");
  config.vendor_id = 0xABCD;
  boot();
  ASSERT_EQ(node->health(), Health::failed);
  hear("703 7F");
  EXPECT_EQ(node->health(), Health::failed);
  peer.replace("603 40 18 10 01 00 00 00 00", "583 43 18 10 01 CD AB 00 00");
  hear("703 00");
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(NodeTest, a_drive_that_dies_in_the_middle_of_its_boot_comes_back_by_heartbeat) {
  peer.forget("603 40 00 16 00 00 00 00 00");
  boot();
  hear("703 7F");  // supervised from here on
  pass(milliseconds(300));
  EXPECT_EQ(node->health(), Health::lost);
  peer.on("603 40 00 16 00 00 00 00 00", "583 4F 00 16 00 02 00 00 00");
  hear("703 7F");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(NodeTest, keeps_the_last_emergency) {
  create();
  hear("083 11 86 21 01 02 03 04 05");
  ASSERT_TRUE(node->lastEmergency().has_value());
  EXPECT_EQ(node->lastEmergency()->code, 0x8611);
  EXPECT_EQ(node->lastEmergency()->error_register, 0x21);
  EXPECT_EQ(node->lastEmergency()->vendor, (std::array<std::uint8_t, 5>{1, 2, 3, 4, 5}));
  hear("083 00 00 00 00 00 00 00 00");
  EXPECT_EQ(node->lastEmergency()->code, 0x0000);
  EXPECT_EQ(node->emergencies(), 2U);
  EXPECT_EQ(node->malformedEmergencies(), 0U);
  hear("083 11");  // no code
  EXPECT_EQ(node->emergencies(), 2U);
  EXPECT_EQ(node->malformedEmergencies(), 1U);
}

TEST_F(NodeTest, a_queued_sdo_transfer_wakes_it_at_once) {
  bootReady();
  EXPECT_GT(node->nextDeadline(), now);
  node->sdo().upload(kStatusword);
  EXPECT_LE(node->nextDeadline(), now);
  node->tick(now);
  EXPECT_EQ(peer.take(), Lines{"603 40 41 60 00 00 00 00 00"});
  EXPECT_GT(node->nextDeadline(), now);
}

TEST_F(NodeTest, answers_by_sdo_are_signs_of_life_while_it_is_configured) {
  const char kAskSync[] = "603 40 05 10 00 00 00 00 00";
  peer.forget(kAskSync);
  peer.forget("603 40 14 10 00 00 00 00 00");
  boot();
  hear("703 7F");  // supervised from here on
  pass(milliseconds(200));
  hear("583 43 05 10 00 80 00 00 00");
  pass(milliseconds(299));
  EXPECT_EQ(node->health(), Health::booting);
  pass(milliseconds(1));
  EXPECT_EQ(node->health(), Health::lost);
}

TEST_F(NodeTest, counts_the_syncs_without_a_tpdo) {
  config.pdos[1].stale_after = 3;
  bootReady();
  tpdo("183 37 02 01 00 00 00");
  for (int i = 0; i < 3; ++i) node->onSync(now);
  EXPECT_TRUE(statusword().fresh);
  node->onSync(now);
  EXPECT_FALSE(statusword().fresh);
}

TEST_F(NodeTest, a_boot_that_failed_is_not_called_a_loss_when_its_heartbeat_ends) {
  peer.replace("603 40 00 18 01 00 00 00 00", "583 80 00 18 01 00 00 02 06");
  peer.forget("603 40 00 16 00 00 00 00 00");
  boot();
  hear("703 7F");  // supervised from here on
  hear("583 4F 00 16 00 02 00 00 00");
  ASSERT_EQ(node->health(), Health::failed);
  pass(seconds(1));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("1800:01"));
}

TEST(NodeHealthText, is_one_word_each) {
  EXPECT_STREQ(toString(Health::absent), "absent");
  EXPECT_STREQ(toString(Health::booting), "booting");
  EXPECT_STREQ(toString(Health::ready), "ready");
  EXPECT_STREQ(toString(Health::failed), "failed");
  EXPECT_STREQ(toString(Health::lost), "lost");
}

}  // namespace
}  // namespace cia402::canopen
