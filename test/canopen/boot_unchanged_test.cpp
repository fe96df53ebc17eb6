// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Configuration that is left out because 1020h says that the drive holds it already.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/boot/signature.h"
#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using test::Lines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// 2026-11-21 is day 15665 = 3D31h since 1984-01-01, 15:30:00 is 55800000 ms = 035370C0h of the day.
const char kReadDate[] = "603 40 20 10 01 00 00 00 00", kReadTime[] = "603 40 20 10 02 00 00 00 00";
const char kDate[] = "583 43 20 10 01 31 3D 00 00", kTime[] = "583 43 20 10 02 C0 70 53 03";
const char kNoDate[] = "583 43 20 10 01 00 00 00 00", kNoTime[] = "583 43 20 10 02 00 00 00 00";
const char kWriteDate[] = "603 23 20 10 01 31 3D 00 00",
           kWriteTime[] = "603 23 20 10 02 C0 70 53 03";
const char kVoidDate[] = "603 23 20 10 01 00 00 00 00", kVoidTime[] = "603 23 20 10 02 00 00 00 00";
const char kAskMap[] = "603 40 00 1A 01 00 00 00 00";  // of a complete look at TPDO 1

/// A drive that holds the configuration of that date and its error control objects.
class BootUnchanged : public test::NodeFixture {
 protected:
  BootUnchanged() {
    config.boot.check = ConfigurationCheck::date;
    config.boot.date = 15665;
    config.boot.time = 55800000;
    peer.on("603 40 16 10 01 00 00 00 00", "583 43 16 10 01 2C 01 7F 00");  // 1016:01
    peer.on("603 40 17 10 00 00 00 00 00", "583 4B 17 10 00 64 00 00 00");  // 1017h = 100 ms
    peer.on(kReadDate, kDate).on(kReadTime, kTime);
    peer.on(kWriteDate, "583 60 20 10 01 00 00 00 00");
    peer.on(kWriteTime, "583 60 20 10 02 00 00 00 00");
    peer.on(kVoidDate, "583 60 20 10 01 00 00 00 00");
    peer.on(kVoidTime, "583 60 20 10 02 00 00 00 00");
  }
  void expectConfigured() {
    EXPECT_EQ(node->health(), Health::ready) << node->problem();
    EXPECT_TRUE(sentLine(kAskMap));
    EXPECT_TRUE(sentLine(kWriteDate) && sentLine(kWriteTime)) << "the proof for the next boot";
    EXPECT_THAT(node->remarks(), IsEmpty());
  }
};

TEST_F(BootUnchanged, leaves_out_what_1020h_proves_and_still_looks_at_samples) {
  config.sync_period_us = 4000;
  peer.on("603 40 06 10 00 00 00 00 00", "583 43 06 10 00 A0 0F 00 00");
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 6, sent.end()),
            (Lines{"603 40 16 10 01 00 00 00 00",  // error control is looked at, not rewritten
                   "603 40 17 10 00 00 00 00 00",  //
                   kReadDate, kReadTime,           //
                   "603 40 06 10 00 00 00 00 00",  // samples: SYNC period
                   "603 40 00 14 01 00 00 00 00",  // RPDO 1: COB-ID, type, number of entries
                   "603 40 00 14 02 00 00 00 00",  //
                   "603 40 00 16 00 00 00 00 00",  //
                   "603 40 00 18 01 00 00 00 00",  // TPDO 1
                   "603 40 00 18 02 00 00 00 00",  //
                   "603 40 00 1A 00 00 00 00 00",  //
                   "000 01 03"}));
  EXPECT_THAT(node->remarks(), ElementsAre(HasSubstr("configuration is unchanged (1020h)")));
  EXPECT_THAT(node->notes(), IsEmpty());
  hear("703 00");
  EXPECT_THAT(node->remarks(), ElementsAre(HasSubstr("configuration is unchanged (1020h)")))
      << "of the last boot alone";
}

TEST_F(BootUnchanged, writes_that_are_no_configuration_are_done_all_the_same) {
  StartupWrite stop;
  stop.object = {0x6040, 0};
  stop.data = {0x02, 0x00};
  stop.only_if_different = false;
  stop.always = true;
  StartupWrite window = stop;
  window.object = {0x6065, 0};
  window.always = false;
  config.writes = {window, stop};
  peer.on("603 2B 40 60 00 02 00 00 00", "583 60 40 60 00 00 00 00 00");
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine("603 2B 40 60 00 02 00 00 00"));
  EXPECT_FALSE(sentLine("603 2B 65 60 00 02 00 00 00"));
}

TEST_F(BootUnchanged, a_drive_that_was_never_configured_is_and_gets_its_proof) {
  peer.replace(kReadDate, kNoDate).replace(kReadTime, kNoTime);
  boot();
  expectConfigured();
  EXPECT_FALSE(sentLine(kVoidDate)) << "it is 0 already";
}

TEST_F(BootUnchanged, another_date_is_made_void_before_the_configuration_begins) {
  peer.replace(kReadTime, "583 43 20 10 02 C1 70 53 03");
  boot();
  expectConfigured();
  const Lines sent = peer.take();
  const auto at = [&](const char* line) {
    return std::find(sent.begin(), sent.end(), line) - sent.begin();
  };
  EXPECT_LT(at(kVoidDate), at(kVoidTime));
  EXPECT_LT(at(kVoidTime), at(kAskMap));
  EXPECT_LT(at(kAskMap), at(kWriteDate));
}

TEST_F(BootUnchanged, half_a_date_is_none) {
  peer.replace(kReadDate, kNoDate);
  boot();
  expectConfigured();
}

TEST_F(BootUnchanged, a_drive_without_1020h_is_configured_at_each_boot_and_that_is_told) {
  peer.replace(kReadDate, "583 80 20 10 01 00 00 02 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine(kAskMap));
  EXPECT_FALSE(sentLine(kWriteDate));
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("cannot be proved unchanged and is written at "
                                                   "each boot: reading 1020:01")));
}

TEST_F(BootUnchanged, a_drive_that_kept_1020h_but_lost_a_pdo_is_caught) {
  peer.replace("603 40 00 16 00 00 00 00 00", {"583 4F 00 16 00 01 00 00 00"});
  peer.on("603 40 00 16 00 00 00 00 00", "583 4F 00 16 00 02 00 00 00");
  boot();
  expectConfigured();
  EXPECT_THAT(node->notes(),
              ElementsAre(HasSubstr("1020h says that its configuration is unchanged, but 1600:00 "
                                    "number of mapped objects is 0x01: it lost its "
                                    "configuration and kept 1020h, and is configured again")));
}

TEST_F(BootUnchanged, a_drive_that_kept_1020h_but_lost_its_heartbeat_time_is_caught) {
  peer.replace("603 40 17 10 00 00 00 00 00", "583 4B 17 10 00 00 00 00 00");
  boot();
  expectConfigured();
  EXPECT_TRUE(sentLine("603 2B 17 10 00 64 00 00 00")) << "supervision is always set up";
  EXPECT_TRUE(node->supervision().watched);
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("its error control objects were not as")));
}

// canopen-python/canopen#395: every answer has four bytes, whatever the type.
TEST_F(BootUnchanged, a_drive_whose_answers_have_four_bytes_is_not_configured_for_that) {
  peer.replace("603 40 17 10 00 00 00 00 00", "583 43 17 10 00 64 00 00 00");
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_FALSE(sentLine("603 2B 17 10 00 64 00 00 00"));
  EXPECT_FALSE(sentLine(kAskMap));
  EXPECT_THAT(node->notes(), IsEmpty());
}

TEST_F(BootUnchanged, a_boot_that_fails_on_its_way_leaves_no_proof) {
  peer.replace(kReadDate, kNoDate);
  config.pdos[0].entries.pop_back();
  peer.on("603 23 00 14 01 03 02 00 80", "583 80 00 14 01 20 00 00 08");
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_TRUE(sentLine(kVoidTime));
  EXPECT_FALSE(sentLine(kWriteDate));
}

TEST_F(BootUnchanged, a_drive_that_refuses_the_proof_is_ready_all_the_same) {
  peer.replace(kReadDate, kNoDate).replace(kReadTime, kNoTime);
  peer.replace(kWriteDate, "583 80 20 10 01 02 00 01 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("will be written again at the next boot")));
}

TEST_F(BootUnchanged,
       what_was_written_for_a_sync_of_others_is_written_again_for_that_of_the_master) {
  config.boot.check = ConfigurationCheck::checksum;
  const Node::Identity identity{0x00020192, 0xABCD, 0x000D0117, 0x00010002, 12345};
  const auto line = [](const char* to, unsigned subindex, std::uint32_t value) {
    char text[40];
    std::snprintf(text, sizeof text, "%s 20 10 %02X %02X %02X %02X %02X", to, subindex, value & 255,
                  value >> 8 & 255, value >> 16 & 255, value >> 24);
    return std::string(text);
  };
  const auto external = configurationSignature(config, identity, true);
  const auto own = configurationSignature(config, identity, false);
  peer.replace(kReadDate, {line("583 43", 1, external.date)});
  peer.replace(kReadTime, {line("583 43", 2, external.time)});
  peer.on(line("603 23", 1, own.date), "583 60 20 10 01 00 00 00 00");
  peer.on(line("603 23", 2, own.time), "583 60 20 10 02 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine(kAskMap));
  EXPECT_TRUE(sentLine(line("603 23", 1, own.date)));
  peer.take();
  master.external_sync = true;
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_FALSE(sentLine(kAskMap)) << "that is what it holds";
}

TEST_F(BootUnchanged, a_pdo_that_is_not_used_is_no_sample) {
  config.pdos[0].enabled = false;
  config.pdos[0].cob_id = 0x3FF;
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_FALSE(sentLine("603 40 00 14 01 00 00 00 00"));
  EXPECT_FALSE(sentLine(kAskMap)) << "it is unchanged";
}

TEST_F(BootUnchanged, pdos_with_cob_ids_of_the_drive_are_asked_for_at_each_boot) {
  config.pdos[0].cob_id = 0;
  const char kAskSyncId[] = "603 40 05 10 00 00 00 00 00";
  peer.forget(kAskSyncId);
  boot();
  pass(std::chrono::milliseconds(100));
  hear("703 04");  // and what it says is told once, though it begins again
  peer.on(kAskSyncId, "583 43 05 10 00 80 00 00 00");
  hear("703 7F");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine(kVoidDate));
  EXPECT_TRUE(sentLine(kAskMap));
  EXPECT_THAT(node->remarks(), ElementsAre(HasSubstr("its PDOs are asked for at each boot")));
  EXPECT_THAT(node->notes(), IsEmpty());
}

TEST_F(BootUnchanged, an_error_control_object_that_cannot_be_set_right_is_tried_once) {
  peer.replace("603 40 17 10 00 00 00 00 00", "583 4B 17 10 00 00 00 00 00");
  peer.replace("603 2B 17 10 00 64 00 00 00", "583 80 17 10 00 02 00 01 06");
  boot();
  node->receiveTpdo(0, test::frame("183 37 02 01 00 00 00"), now);
  pass(std::chrono::milliseconds(0));
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_EQ(std::count(peer.sent.begin(), peer.sent.end(), "603 2B 17 10 00 64 00 00 00"), 1);
  EXPECT_FALSE(node->supervision().watched);
}

TEST_F(BootUnchanged, a_proof_that_is_not_confirmed_fails_the_boot) {
  peer.replace(kReadDate, kNoDate).replace(kReadTime, kNoTime);
  peer.forget(kWriteDate);
  boot();
  pass(std::chrono::seconds(1));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("1020:01 configuration date: no answer"));
}

TEST_F(BootUnchanged, nothing_is_configured_before_the_old_proof_is_void) {
  peer.replace(kReadTime, "583 43 20 10 02 C1 70 53 03");
  peer.forget(kVoidTime);
  boot();
  EXPECT_EQ(peer.take().back(), kVoidTime);
  EXPECT_EQ(node->bootStep(), "writing 0x00000000 to 1020:02 configuration time");
  hear("583 60 20 10 02 00 00 00 00");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine(kAskMap));
}

TEST_F(BootUnchanged, half_a_proof_that_says_nothing_need_not_be_made_void) {
  peer.replace(kReadDate, kNoDate).replace(kReadTime, "583 80 20 10 02 11 00 09 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_FALSE(sentLine(kVoidDate));
  EXPECT_TRUE(sentLine(kAskMap));
}

// The same numbers in the same order, but for where the mapping of the first PDO ends.
TEST(ConfigurationSignatureTest, tells_whose_mapping_an_entry_belongs_to) {
  NodeConfig longer;
  longer.boot.check = ConfigurationCheck::checksum;
  PdoConfig first, second;
  first.direction = PdoDirection::tpdo;
  first.number = 1;
  first.entries = {{{0x0000, 1}, 2, ""}};
  second.direction = PdoDirection::tpdo;
  second.number = 1;
  second.enabled = true;
  second.cob_id = 1;
  second.transmission = 1;
  second.inhibit = 5;
  second.event_timer = 8;
  longer.pdos = {first, second};
  NodeConfig shorter = longer;
  shorter.pdos[0].entries.clear();
  shorter.pdos[1].direction = static_cast<PdoDirection>(1);  // the entry's object, 0000:01
  shorter.pdos[1].number = 2;                                // its bits
  shorter.pdos[1].enabled = true;                            // tpdo, 1
  shorter.pdos[1].cob_id = 1;                                // the number
  shorter.pdos[1].transmission = 1;                          // enabled
  shorter.pdos[1].inhibit = 1;                               // the COB-ID
  shorter.pdos[1].event_timer = 1;                           // the transmission type
  shorter.pdos[1].entries = {{{0x0000, 5}, 8, ""}};          // inhibit time and event timer
  ASSERT_EQ(static_cast<int>(PdoDirection::tpdo), 1);
  const auto one = configurationSignature(longer, {}, false);
  const auto other = configurationSignature(shorter, {}, false);
  EXPECT_FALSE(one.date == other.date && one.time == other.time);
}

// 6065:00 is 00 65 60 00 00 00 00 00 among the bytes that are summed up.
TEST(ConfigurationSignatureTest, tells_where_the_data_of_a_write_end) {
  NodeConfig one;
  one.boot.check = ConfigurationCheck::checksum;
  StartupWrite first, second;
  first.object = {0x6067, 0};
  first.data = {0x00, 0x65, 0x60, 0x00, 0x00, 0x00, 0x00, 0x00};
  second.object = {0x6065, 0};
  one.writes = {first, second};
  NodeConfig other = one;
  std::swap(other.writes[0].data, other.writes[1].data);
  const auto sum = configurationSignature(one, {}, false);
  const auto other_sum = configurationSignature(other, {}, false);
  EXPECT_FALSE(sum.date == other_sum.date && sum.time == other_sum.time);
}

TEST(ConfigurationSignatureTest, changes_with_everything_that_a_boot_writes_and_with_the_device) {
  NodeConfig config = test::servoConfig(3, "shoulder");
  config.boot.check = ConfigurationCheck::checksum;
  StartupWrite write;
  write.object = {0x6065, 0};
  write.data = {1, 2, 3, 4};
  config.writes = {write};
  Node::Identity identity;
  bool external = false;
  const auto signature = [&](const NodeConfig& of) {
    const ConfigurationSignature s = configurationSignature(of, identity, external);
    EXPECT_GE(s.date, 1U);
    EXPECT_LE(s.date, 0xFFFFU);
    EXPECT_GE(s.time, 1U);
    EXPECT_LT(s.time, 86400000U);
    return std::make_pair(s.date, s.time);
  };
  const auto first = signature(config);
  EXPECT_EQ(signature(config), first);
  const auto differs = [&](auto&& change) {
    NodeConfig other = config;
    change(other);
    return signature(other) != first;
  };
  EXPECT_TRUE(differs([](NodeConfig& c) { c.writes[0].data[3] = 5; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.writes[0].object.subindex = 1; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.writes.clear(); }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.pdos[0].transmission = 2; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.pdos[0].event_timer = 5; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.pdos[0].inhibit = 5; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.pdos[0].enabled = false; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.pdos[0].cob_id = 0x301; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.pdos[1].entries[0].object.index = 0x6042; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.pdos[1].entries[0].bits = 8; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.heartbeat *= 2; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.master_timeout *= 2; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.error_control = ErrorControl::guarding; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.life_time_factor = 4; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.sync_period_us = 4000; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.sync_counter = 0; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.pdos[0].direction = PdoDirection::tpdo; }) ||
              differs([](NodeConfig& c) { c.pdos[0].direction = PdoDirection::rpdo; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.pdos[0].number = 4; }));
  EXPECT_TRUE(differs([](NodeConfig& c) { c.node_id = 4; }));
  external = true;  // 1005h may let a drive make SYNC
  EXPECT_NE(signature(config), first);
  external = false;
  identity.revision = 0x00010003;  // another firmware
  EXPECT_NE(signature(config), first);
  identity = Node::Identity();
  identity.serial = 1;
  EXPECT_NE(signature(config), first);
}

}  // namespace
}  // namespace cia402::canopen
