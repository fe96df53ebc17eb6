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
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BootTest : public test::NodeFixture {};

const char kAskProduct[] = "603 40 18 10 02 00 00 00 00";

TEST_F(BootTest, identifies_configures_and_starts_a_drive_frame_by_frame) {
  config.pdos.clear();
  peer.replace("603 40 00 14 01 00 00 00 00", "583 80 00 14 01 00 00 02 06");
  peer.replace("603 40 00 18 01 00 00 00 00", "583 80 00 18 01 00 00 02 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_EQ(peer.take(),
            (Lines{"000 82 03",                    // reset communication, then boot-up
                   "603 40 00 10 00 00 00 00 00",  // device type
                   "603 40 18 10 01 00 00 00 00",  // identity
                   "603 40 18 10 02 00 00 00 00",  //
                   "603 40 18 10 03 00 00 00 00",  //
                   "603 40 18 10 04 00 00 00 00",  //
                   "603 23 16 10 01 2C 01 7F 00",  // watch node 127, 300 ms
                   "603 2B 17 10 00 64 00 00 00",  // heartbeat every 100 ms
                   "603 40 05 10 00 00 00 00 00",  // does it make SYNC?
                   "603 40 14 10 00 00 00 00 00",  // where do its emergencies go?
                   "603 40 00 14 01 00 00 00 00",  // is there an RPDO to disable?
                   "603 40 01 14 01 00 00 00 00",  //
                   "603 40 02 14 01 00 00 00 00",  //
                   "603 40 03 14 01 00 00 00 00",  //
                   "603 40 00 18 01 00 00 00 00",  // a TPDO?
                   "603 40 01 18 01 00 00 00 00",  //
                   "603 40 02 18 01 00 00 00 00",  //
                   "603 40 03 18 01 00 00 00 00",  //
                   "000 01 03"}));                 // start
  ASSERT_TRUE(node->identity().has_value());
  EXPECT_EQ(node->identity()->device_type, 0x00020192U);
  EXPECT_EQ(node->identity()->vendor_id, 0x0000ABCDU);
  EXPECT_EQ(node->identity()->product_code, 0x000D0117U);
  EXPECT_EQ(node->identity()->revision, 0x00010002U);
  EXPECT_EQ(node->identity()->serial, 12345U);
  EXPECT_THAT(node->notes(), IsEmpty());
  EXPECT_EQ(node->problem(), "");
  EXPECT_EQ(node->nmtState(), NmtState::operational);
}

TEST_F(BootTest, goes_on_with_each_answer_without_any_tick) {
  boot();
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(BootTest, writes_nothing_to_pdos_that_are_as_wanted) {
  boot();
  for (const std::string& sent : peer.take()) {
    const bool download = sent.substr(0, 5) == "603 2";
    const bool heartbeat = sent.substr(6, 5) == " 16 1" || sent.substr(6, 5) == " 17 1";
    EXPECT_TRUE(!download || heartbeat) << sent;
  }
}

TEST_F(BootTest, a_boot_up_followed_at_once_by_a_heartbeat_is_not_missed) {
  peer.replace("000 82 03", {"703 00", "703 7F"});
  const Time start = now;
  boot();
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(node->bootUps(), 1U);
  EXPECT_EQ(now, start);
}

TEST_F(BootTest, waits_for_the_boot_up_before_it_asks_anything) {
  peer.forget("000 82 03");
  boot();
  pass(milliseconds(1000));
  hear("703 7F");  // a heartbeat of before the reset
  EXPECT_EQ(peer.take(), Lines{"000 82 03"});
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_EQ(node->bootStep(), "waiting for boot-up");
  hear("703 00");
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(BootTest, a_drive_that_ignores_the_reset_is_found_by_asking_and_made_pre_operational) {
  peer.forget("000 82 03");
  boot();
  pass(milliseconds(1249));
  EXPECT_EQ(peer.take(), Lines{"000 82 03"});
  pass(milliseconds(1));
  EXPECT_EQ(node->health(), Health::ready);
  const Lines sent = peer.take();
  EXPECT_EQ(sent[0], kAskDeviceType);
  EXPECT_EQ(sent[1], "000 80 03");
}

TEST_F(BootTest, without_a_reset_it_is_made_pre_operational_first) {
  boot(false);
  EXPECT_EQ(node->health(), Health::ready);
  const Lines sent = peer.take();
  EXPECT_EQ(sent[0], "000 80 03");
  EXPECT_EQ(sent[1], kAskDeviceType);
}

TEST_F(BootTest, nobody_there_is_absent_and_told_what_to_check) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  const Time start = now;
  boot();
  pass(milliseconds(4999));
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_EQ(node->bootStep(), "reading 1000:00 device type");
  pass(milliseconds(500));
  EXPECT_EQ(node->health(), Health::absent);
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): does not answer: neither a boot-up message nor an answer to "
            "reading 1000:00 device type came within 5 s; check power, cable and termination, bit "
            "rate and node-ID");
  EXPECT_EQ(node->nextDeadline(), start + milliseconds(5250) + seconds(2)) << "the first look";
}

TEST_F(BootTest, an_absent_node_boots_when_it_is_switched_on_later) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  boot();
  pass(seconds(10));
  ASSERT_EQ(node->health(), Health::absent);
  peer.on(kAskDeviceType, "583 43 00 10 00 92 01 02 00");
  hear("703 00");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(node->problem(), "");
}

TEST_F(BootTest, an_absent_node_boots_at_its_first_heartbeat) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  boot();
  pass(seconds(10));
  peer.take();
  peer.on(kAskDeviceType, "583 43 00 10 00 92 01 02 00");
  hear("703 05");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(peer.take()[0], "000 80 03");
}

TEST_F(BootTest, a_node_with_heartbeat_but_without_sdo_answers_has_failed_not_vanished) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  boot();
  pass(seconds(2));
  hear("703 7F");
  pass(seconds(4));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(
      node->problem(),
      HasSubstr("shoulder (node 3): boot failed: its heartbeat comes (NMT state "
                "pre-operational), but reading 1000:00 device type got no answer for 5 s, "
                "asked again and again: its SDO server is mute; look at the COB-IDs of that "
                "server (1200h in the drive, `sdo` in the configuration), for another SDO "
                "client (a maker's tool) or a second device with this node-ID, and whether "
                "the drive is still starting up"));
}

TEST_F(BootTest, a_node_that_booted_up_and_answers_nothing_is_not_said_to_be_silent) {
  peer.forget(kAskDeviceType);
  boot();
  pass(seconds(6));
  EXPECT_EQ(node->health(), Health::absent) << "it is looked for";
  EXPECT_THAT(node->problem(), HasSubstr("does not answer: its boot-up message came, but reading "
                                         "1000:00 device type got no answer for 5 s"));
  EXPECT_THAT(node->problem(), HasSubstr("1200h"));
}

TEST_F(BootTest, a_node_whose_sdo_server_falls_mute_under_way_is_told_with_its_heartbeat) {
  config.product_code = 0x0D;  // it must be there: that it alone is silent does not make it missing
  peer.forget(kAskProduct);
  boot();
  pass(milliseconds(400));
  hear("703 7F");
  pass(seconds(1));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(),
              HasSubstr("boot failed while reading 1018:02 product code: no answer within 500 ms, "
                        "asked 2 times; its heartbeat goes on (NMT state pre-operational): its SDO "
                        "server is mute"));
}

TEST_F(BootTest, without_a_heartbeat_since_the_question_nothing_is_said_of_the_sdo_server) {
  config.product_code = 0x0D;  // else it is asked for once more, and the lost heartbeat comes first
  peer.forget(kAskVendor);
  boot();
  hear("703 7F");
  pass(milliseconds(100));
  peer.forget(kAskProduct);
  hear("583 43 18 10 01 CD AB 00 00");
  pass(milliseconds(1500));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("1018:02 product code"));
  EXPECT_THAT(node->problem(), Not(HasSubstr("heartbeat")));
}

TEST_F(BootTest, a_heartbeat_of_before_the_reset_is_no_sign_of_life) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  boot();
  hear("703 05");
  pass(seconds(6));
  EXPECT_EQ(node->health(), Health::absent);
}

TEST_F(BootTest, another_product_than_configured_is_told_with_both_numbers) {
  config.product_code = 0x000D0117;
  peer.replace(kAskProduct, "583 43 18 10 02 05 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): is another drive than configured: 1018:02 product code is "
            "0x00000005, configured is 0x000D0117; check node-ID and wiring, or correct "
            "`identity` in the configuration");
  EXPECT_EQ(peer.take().back(), kAskProduct);  // nothing was written to a strange drive
}

TEST_F(BootTest, compares_every_part_of_the_identity_that_is_configured) {
  config.device_type = 0x00020192;
  config.vendor_id = 0xABCD;
  config.product_code = 0x000D0117;
  config.revision = 0x00010002;
  config.serial = 12345;
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  const auto mismatch = [&](std::optional<std::uint32_t> NodeConfig::*part) {
    const std::optional<std::uint32_t> right = config.*part;
    config.*part = 1;
    boot();
    config.*part = right;
    return node->problem();
  };
  EXPECT_THAT(mismatch(&NodeConfig::device_type), HasSubstr("1000:00 device type is 0x00020192"));
  EXPECT_THAT(mismatch(&NodeConfig::vendor_id), HasSubstr("1018:01 vendor id is 0x0000ABCD"));
  EXPECT_THAT(mismatch(&NodeConfig::revision), HasSubstr("1018:03 revision number is 0x00010002"));
  EXPECT_THAT(mismatch(&NodeConfig::serial), HasSubstr("1018:04 serial number is 0x00003039"));
}

TEST_F(BootTest, missing_identity_entries_matter_only_if_configured) {
  peer.replace(kAskProduct, "583 80 18 10 02 11 00 09 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready);
  config.product_code = 7;
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): boot failed while reading 1018:02 product code: the drive refused: "
            "0x06090011 (sub-index does not exist)");
}

TEST_F(BootTest, a_time_out_is_retried_then_told_with_step_object_and_reason) {
  peer.forget(kAskVendor);
  boot();
  EXPECT_EQ(node->bootStep(), "reading 1018:01 vendor id");
  pass(milliseconds(999));
  EXPECT_EQ(node->health(), Health::booting);
  pass(milliseconds(1));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): boot failed while reading 1018:01 vendor id: no answer within 500 "
            "ms, asked 2 times; it is tried again in 1 s (attempt 2 of 3)");
  peer.on(kAskVendor, "583 43 18 10 01 CD AB 00 00");
  node->boot(now, true);
  settle();
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(BootTest, a_second_boot_up_during_boot_starts_over) {
  peer.forget(kAskVendor);
  boot();
  EXPECT_EQ(node->bootStep(), "reading 1018:01 vendor id");
  peer.take();
  peer.on(kAskVendor, "583 43 18 10 01 CD AB 00 00");
  hear("703 00");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(node->bootUps(), 2U);
  const Lines sent = peer.take();
  EXPECT_EQ(sent[1], kAskDeviceType);  // after the abort of the interrupted read
}

TEST_F(BootTest, refused_heartbeat_objects_are_notes_not_errors) {
  peer.replace("603 23 16 10 01 2C 01 7F 00", "583 80 16 10 01 00 00 02 06");
  peer.replace("603 2B 17 10 00 64 00 00 00", "583 80 17 10 00 00 00 02 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_THAT(
      node->notes(),
      ElementsAre(
          "cannot notice a dead master: writing 0x007F012C to 1016:01 consumer heartbeat time: the "
          "drive refused: 0x06020000 (object does not exist in the object dictionary)",
          "not supervised, its loss will go unnoticed: writing 0x0064 to 1017:00 producer "
          "heartbeat time: the drive refused: 0x06020000 (object does not exist in the object "
          "dictionary)"));
  pass(seconds(10));
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(BootTest, disables_an_enabled_pdo_that_nobody_configured) {
  peer.replace("603 40 02 18 01 00 00 00 00", "583 43 02 18 01 83 03 00 40")
      .on("603 40 02 18 01 00 00 00 00", "583 43 02 18 01 83 03 00 C0")
      .on("603 23 02 18 01 83 03 00 C0", "583 60 02 18 01 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine("603 23 02 18 01 83 03 00 C0"));
}

TEST_F(BootTest, notes_an_unconfigured_pdo_that_cannot_be_disabled) {
  peer.replace("603 40 02 18 01 00 00 00 00", "583 43 02 18 01 83 03 00 00")
      .on("603 23 02 18 01 83 03 00 80", "583 80 02 18 01 02 00 01 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(node->notes(),
              ElementsAre(HasSubstr("a PDO that is not configured could not be disabled: TPDO 3")));
}

TEST_F(BootTest, a_pdo_that_cannot_be_configured_fails_the_boot) {
  peer.replace("603 40 00 1A 00 00 00 00 00", "583 4F 00 1A 00 00 00 00 00")
      .on("603 23 00 18 01 83 01 00 80", "583 60 00 18 01 00 00 00 00")
      .on("603 2F 00 1A 00 00 00 00 00", "583 80 00 1A 00 20 00 00 08");
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): boot failed: TPDO 1: writing 0x00 to 1A00:00 number of entries of "
            "TPDO 1: the drive refused: 0x08000020 (data cannot be transferred or stored to the "
            "application)");
}

}  // namespace
}  // namespace cia402::canopen
