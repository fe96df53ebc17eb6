// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using test::Lines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class BootSyncTest : public test::NodeFixture {};

TEST_F(BootSyncTest, stops_the_sync_period_before_it_changes_the_sync_counter) {
  config.sync_counter = 0;
  config.sync_period_us = 4000;
  peer.on("603 40 19 10 00 00 00 00 00", "583 4F 19 10 00 F0 00 00 00")   // 240
      .on("603 40 06 10 00 00 00 00 00", "583 43 06 10 00 10 27 00 00")   // 10000 us
      .on("603 23 06 10 00 00 00 00 00", "583 60 06 10 00 00 00 00 00")   // 0
      .on("603 2F 19 10 00 00 00 00 00", "583 60 19 10 00 00 00 00 00")   // 0
      .on("603 23 06 10 00 A0 0F 00 00", "583 60 06 10 00 00 00 00 00");  // 4000 us
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 10, sent.begin() + 15),
            (Lines{"603 40 19 10 00 00 00 00 00", "603 40 06 10 00 00 00 00 00",
                   "603 23 06 10 00 00 00 00 00", "603 2F 19 10 00 00 00 00 00",
                   "603 23 06 10 00 A0 0F 00 00"}));
}

TEST_F(BootSyncTest, puts_the_sync_period_back_where_only_the_counter_is_configured) {
  config.sync_counter = 10;
  peer.on("603 40 19 10 00 00 00 00 00", "583 4F 19 10 00 00 00 00 00")
      .on("603 40 06 10 00 00 00 00 00", "583 43 06 10 00 10 27 00 00")
      .on("603 23 06 10 00 00 00 00 00", "583 60 06 10 00 00 00 00 00")
      .on("603 2F 19 10 00 0A 00 00 00", "583 60 19 10 00 00 00 00 00")
      .on("603 23 06 10 00 10 27 00 00", "583 60 06 10 00 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine("603 23 06 10 00 10 27 00 00"));
}

TEST_F(BootSyncTest, leaves_sync_objects_alone_that_are_as_wanted) {
  config.sync_counter = 0;
  config.sync_period_us = 4000;
  peer.on("603 40 19 10 00 00 00 00 00", "583 4F 19 10 00 00 00 00 00")
      .on("603 40 06 10 00 00 00 00 00", "583 43 06 10 00 A0 0F 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(BootSyncTest, a_drive_without_sync_counter_is_right_for_a_plain_sync_only) {
  config.sync_counter = 0;
  peer.on("603 40 19 10 00 00 00 00 00", "583 80 19 10 00 00 00 02 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  config.sync_counter = 10;
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), AllOf(HasSubstr("1019:00 synchronous counter overflow value"),
                                     HasSubstr("write `sync_counter: 0` under `bus`")));
}

TEST_F(BootSyncTest, a_sync_counter_that_the_drive_refuses_fails_the_boot) {
  config.sync_counter = 10;
  peer.on("603 40 19 10 00 00 00 00 00", "583 4F 19 10 00 00 00 00 00")
      .on("603 40 06 10 00 00 00 00 00", "583 43 06 10 00 10 27 00 00")
      .on("603 23 06 10 00 00 00 00 00", "583 60 06 10 00 00 00 00 00")
      .on("603 2F 19 10 00 0A 00 00 00", "583 80 19 10 00 02 00 01 06")
      .on("603 23 06 10 00 10 27 00 00", "583 60 06 10 00 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("writing 0x0A to 1019:00 synchronous counter overflow "
                                         "value: the drive refused: 0x06010002"));
  EXPECT_FALSE(sentLine("000 01 03"));
}

TEST_F(BootSyncTest, a_drive_without_sync_period_goes_without_and_that_is_told) {
  config.sync_period_us = 4000;
  peer.on("603 40 06 10 00 00 00 00 00", "583 80 06 10 00 00 00 02 06");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("does not know the SYNC period: reading "
                                                   "1006:00 communication cycle period")));
  EXPECT_FALSE(sentLine("603 23 06 10 00 A0 0F 00 00"));
}

TEST_F(BootSyncTest, a_period_of_zero_is_written_once_where_it_is_also_the_wanted_one) {
  config.sync_counter = 10;
  config.sync_period_us = 0;
  peer.on("603 40 19 10 00 00 00 00 00", "583 4F 19 10 00 00 00 00 00")
      .on("603 40 06 10 00 00 00 00 00", "583 43 06 10 00 10 27 00 00")
      .on("603 23 06 10 00 00 00 00 00", "583 60 06 10 00 00 00 00 00")
      .on("603 2F 19 10 00 0A 00 00 00", "583 60 19 10 00 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_EQ(std::count(peer.sent.begin(), peer.sent.end(), "603 23 06 10 00 00 00 00 00"), 1);
}

}  // namespace
}  // namespace cia402::canopen
