// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using test::Lines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BootCobIdsTest : public test::NodeFixture {};

TEST_F(BootCobIdsTest, a_drive_that_makes_sync_itself_is_told_to_stop) {
  peer.replace("603 40 05 10 00 00 00 00 00", "583 43 05 10 00 80 00 00 40")
      .on("603 23 05 10 00 80 00 00 00", "583 60 05 10 00 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine("603 23 05 10 00 80 00 00 00"));
}

TEST_F(BootCobIdsTest, a_drive_that_goes_on_to_make_sync_is_refused) {
  peer.replace("603 40 05 10 00 00 00 00 00", "583 43 05 10 00 80 00 00 40")
      .on("603 23 05 10 00 80 00 00 00", "583 80 05 10 00 02 00 01 06");
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("the drive makes SYNC itself (1005:00 COB-ID SYNC is "
                                         "0x40000080), as the master does, and refuses to change"));
}

TEST_F(BootCobIdsTest, another_sync_identifier_is_set_right_or_refused) {
  peer.replace("603 40 05 10 00 00 00 00 00", "583 43 05 10 00 81 00 00 00")
      .on("603 23 05 10 00 80 00 00 00", "583 60 05 10 00 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  peer.replace("603 23 05 10 00 80 00 00 00", "583 80 05 10 00 02 00 01 06");
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("the drive waits for another SYNC (1005:00"));
}

TEST_F(BootCobIdsTest, another_sync_identifier_matters_only_to_pdos_that_are_sent_by_sync) {
  peer.replace("603 40 05 10 00 00 00 00 00", "583 43 05 10 00 81 00 00 00")
      .on("603 23 05 10 00 80 00 00 00", "583 80 05 10 00 02 00 01 06");
  const auto refused = [&](std::uint8_t transmission, bool enabled) {
    for (PdoConfig& pdo : config.pdos) pdo.transmission = 254;
    config.pdos.back().transmission = transmission;
    config.pdos.back().enabled = enabled;
    boot();
    pass(std::chrono::seconds(10));
    return node->problem().find("the drive waits for another SYNC (1005:00") != std::string::npos;
  };
  // CiA 301, 7.5.2.36: 0 to 240 with SYNC, 254 and 255 by events.
  EXPECT_TRUE(refused(0, true));
  EXPECT_TRUE(refused(1, true));
  EXPECT_TRUE(refused(240, true));
  EXPECT_FALSE(refused(241, true)) << "reserved";
  EXPECT_FALSE(refused(254, true));
  EXPECT_FALSE(refused(255, true));
  EXPECT_FALSE(refused(1, false));
}

TEST_F(BootCobIdsTest, emergencies_under_another_identifier_are_switched_off_then_set_right) {
  peer.replace("603 40 14 10 00 00 00 00 00", "583 43 14 10 00 90 00 00 00")
      .on("603 23 14 10 00 90 00 00 80", "583 60 14 10 00 00 00 00 00")
      .on("603 23 14 10 00 83 00 00 00", "583 60 14 10 00 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  const Lines sent = peer.take();
  const auto disabled = std::find(sent.begin(), sent.end(), "603 23 14 10 00 90 00 00 80");
  ASSERT_NE(disabled, sent.end());
  EXPECT_EQ(*(disabled + 1), "603 23 14 10 00 83 00 00 00");
}

TEST_F(BootCobIdsTest, emergencies_that_are_disabled_are_enabled_or_told) {
  peer.replace("603 40 14 10 00 00 00 00 00", "583 43 14 10 00 83 00 00 80")
      .on("603 23 14 10 00 83 00 00 00", "583 60 14 10 00 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(node->notes(), IsEmpty());
  peer.replace("603 23 14 10 00 83 00 00 00", "583 80 14 10 00 02 00 01 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("its emergencies go unheard (1014:00 COB-ID "
                                                   "EMCY is 0x80000083)")));
}

TEST_F(BootCobIdsTest, a_drive_without_1005h_and_1014h_is_taken_as_the_standard_predefines) {
  peer.replace("603 40 05 10 00 00 00 00 00", "583 80 05 10 00 00 00 02 06")
      .replace("603 40 14 10 00 00 00 00 00", "583 80 14 10 00 00 00 02 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(node->notes(), IsEmpty());
}

}  // namespace
}  // namespace cia402::canopen
