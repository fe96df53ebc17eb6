// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Entries that the drive need not have, and entries for which there was room.
#include "canopen/pdo_configurator_fixture.h"

namespace cia402::canopen {
namespace {

using namespace test;
using ::testing::HasSubstr;

// The position may be missing: 6064:00 is entry 2.
PdoConfig withOptionalPosition() {
  PdoConfig wanted = wantedTpdo();
  wanted.entries[1].optional = true;
  return wanted;
}
const char kCount1[] = "583 4F 00 1A 00 01 00 00 00";
const char kWriteCount1[] = "603 2F 00 1A 00 01 00 00 00";

TEST_F(PdoConfiguratorTest, leaves_out_an_optional_entry_that_the_drive_refuses) {
  for (const char* refusal : {"583 80 00 1A 02 41 00 04 06", "583 80 00 1A 02 00 00 02 06",
                              "583 80 00 1A 02 11 00 09 06"}) {
    peer = ScriptedPeer();
    peer.on(kReadCount, kCount0).on(kReadCount, kCount1);
    peer.on(kReadCobId, kCobIdEnabled).on(kReadType, kType1).on(kReadInhibit, kInhibit0);
    peer.on(kReadTimer, kTimer0).on(kReadEntry1, kEntry1);
    peer.on(kDisable, kCobIdDone).on(kClearMap, kCountDone).on(kWriteEntry1, kEntry1Done);
    peer.on(kWriteEntry2, refusal).on(kWriteCount1, kCountDone).on(kEnable, kCobIdDone);
    EXPECT_EQ(run(withOptionalPosition()), Status::done) << configurator->error();
    ASSERT_EQ(configurator->leftOut().size(), 1U);
    EXPECT_EQ(configurator->leftOut()[0].object, (ObjectId{0x6064, 0}));
  }
}

TEST_F(PdoConfiguratorTest, an_optional_entry_that_is_refused_for_another_reason_is_an_error) {
  peer.on(kReadCount, kCount0).on(kDisable, kCobIdDone).on(kClearMap, kCountDone);
  peer.on(kWriteEntry1, kEntry1Done).on(kWriteEntry2, "583 80 00 1A 02 42 00 04 06");
  allAsWanted();
  EXPECT_EQ(run(withOptionalPosition()), Status::failed);
  EXPECT_THAT(configurator->error(), HasSubstr("0x06040042"));
}

// The position is there only because there was room for it.
PdoConfig withRider() {
  PdoConfig wanted = withOptionalPosition();
  wanted.entries[1].if_room = true;
  return wanted;
}

TEST_F(PdoConfiguratorTest, what_is_there_for_the_room_only_is_left_out_whatever_the_reason) {
  // 06040042: longer than the PDO; 08000000: general error; 06040043: incompatible parameters.
  for (const char* refusal : {"583 80 00 1A 02 42 00 04 06", "583 80 00 1A 02 00 00 00 08",
                              "583 80 00 1A 02 43 00 04 06"}) {
    peer = ScriptedPeer();
    peer.on(kReadCount, kCount0).on(kReadCount, kCount1);
    peer.on(kReadCobId, kCobIdEnabled).on(kReadType, kType1).on(kReadInhibit, kInhibit0);
    peer.on(kReadTimer, kTimer0).on(kReadEntry1, kEntry1);
    peer.on(kDisable, kCobIdDone).on(kClearMap, kCountDone).on(kWriteEntry1, kEntry1Done);
    peer.on(kWriteEntry2, refusal).on(kWriteCount1, kCountDone).on(kEnable, kCobIdDone);
    EXPECT_EQ(run(withRider()), Status::done) << configurator->error();
    ASSERT_EQ(configurator->leftOut().size(), 1U);
    EXPECT_TRUE(configurator->leftOut()[0].if_room);
  }
}

TEST_F(PdoConfiguratorTest,
       what_is_there_for_the_room_only_goes_where_the_pdo_is_refused_as_a_whole) {
  peer.on(kReadCount, kCount0).on(kReadCount, kCount1);
  peer.on(kReadCobId, kCobIdEnabled).on(kReadType, kType1).on(kReadInhibit, kInhibit0);
  peer.on(kReadTimer, kTimer0).on(kReadEntry1, kEntry1);
  peer.on(kDisable, kCobIdDone).on(kClearMap, kCountDone).on(kWriteEntry1, kEntry1Done);
  peer.on(kWriteEntry2, kEntry2Done).on(kWriteCount, "583 80 00 1A 00 42 00 04 06");
  peer.on(kWriteCount1, kCountDone).on(kEnable, kCobIdDone);
  EXPECT_EQ(run(withRider()), Status::done) << configurator->error();
  ASSERT_EQ(configurator->leftOut().size(), 1U);
  EXPECT_EQ(configurator->leftOut()[0].object, (ObjectId{0x6064, 0}));
}

// Entry 1 is the optional one; what follows moves up to its place.
TEST_F(PdoConfiguratorTest, what_follows_an_entry_that_is_left_out_moves_up) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries[0].optional = true;
  const char kEntry1Position[] = "603 23 00 1A 01 20 00 64 60";
  peer.on(kReadCount, kCount0).on(kReadCount, kCount1);
  peer.on(kReadCobId, kCobIdEnabled).on(kReadType, kType1).on(kReadInhibit, kInhibit0);
  peer.on(kReadTimer, kTimer0).on(kReadEntry1, "583 43 00 1A 01 20 00 64 60");
  peer.on(kDisable, kCobIdDone).on(kClearMap, kCountDone);
  peer.on(kWriteEntry1, "583 80 00 1A 01 41 00 04 06").on(kEntry1Position, kEntry1Done);
  peer.on(kWriteCount1, kCountDone).on(kEnable, kCobIdDone);
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_EQ(configurator->leftOut().at(0).object, (ObjectId{0x6041, 0}));
}

TEST_F(PdoConfiguratorTest, a_pdo_of_which_nothing_is_left_stays_invalid) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries.erase(wanted.entries.begin());
  wanted.entries[0].optional = true;
  peer.on(kReadCobId, kCobIdEnabled).on(kReadCobId, kCobIdDisabled);
  peer.on(kReadType, kType1).on(kReadInhibit, kInhibit0).on(kReadTimer, kTimer0);
  peer.on(kReadCount, kCount0).on(kDisable, kCobIdDone).on(kClearMap, kCountDone);
  peer.on("603 23 00 1A 01 20 00 64 60", "583 80 00 1A 01 41 00 04 06");
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_EQ(configurator->leftOut().size(), 1U);
  EXPECT_EQ(peer.take().back(), kReadCobId) << "nothing was written behind it";
}

// Some drives take every entry and judge all of them when their number is written.
TEST_F(PdoConfiguratorTest, finds_out_by_reading_which_optional_entry_is_missing) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries[0].optional = wanted.entries[1].optional = true;
  peer.on(kReadCount, kCount0).on(kReadCount, kCount1);
  peer.on(kReadCobId, kCobIdEnabled).on(kReadType, kType1).on(kReadInhibit, kInhibit0);
  peer.on(kReadTimer, kTimer0).on(kReadEntry1, kEntry1);
  peer.on(kDisable, kCobIdDone).on(kClearMap, kCountDone).on(kWriteEntry1, kEntry1Done);
  peer.on(kWriteEntry2, kEntry2Done).on(kWriteCount, "583 80 00 1A 00 41 00 04 06");
  peer.on("603 40 41 60 00 00 00 00 00", "583 4B 41 60 00 50 02 00 00");
  peer.on("603 40 64 60 00 00 00 00 00", "583 80 64 60 00 00 00 02 06");
  peer.on(kWriteCount1, kCountDone).on(kEnable, kCobIdDone);
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  ASSERT_EQ(configurator->leftOut().size(), 1U);
  EXPECT_EQ(configurator->leftOut()[0].object, (ObjectId{0x6064, 0}));
}

TEST_F(PdoConfiguratorTest, leaves_out_the_last_optional_entry_where_all_can_be_read) {
  peer.on(kReadCount, kCount0).on(kReadCount, kCount1);
  peer.on(kReadCobId, kCobIdEnabled).on(kReadType, kType1).on(kReadInhibit, kInhibit0);
  peer.on(kReadTimer, kTimer0).on(kReadEntry1, kEntry1);
  peer.on(kDisable, kCobIdDone).on(kClearMap, kCountDone).on(kWriteEntry1, kEntry1Done);
  peer.on(kWriteEntry2, kEntry2Done).on(kWriteCount, "583 80 00 1A 00 41 00 04 06");
  peer.on("603 40 64 60 00 00 00 00 00", "583 43 64 60 00 10 00 00 00");
  peer.on(kWriteCount1, kCountDone).on(kEnable, kCobIdDone);
  EXPECT_EQ(run(withOptionalPosition()), Status::done) << configurator->error();
  EXPECT_EQ(configurator->leftOut().size(), 1U);
}

TEST_F(PdoConfiguratorTest, a_pdo_of_optional_entries_alone_may_be_missing) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries[0].optional = wanted.entries[1].optional = true;
  peer.on(kReadCobId, "583 80 00 18 01 00 00 02 06");
  EXPECT_EQ(run(wanted), Status::done);
  EXPECT_EQ(configurator->leftOut().size(), 2U);
  peer.on(kReadCobId, "583 80 00 18 01 00 00 02 06");
  EXPECT_EQ(run(withOptionalPosition()), Status::failed) << "the statusword is needed";
}

}  // namespace
}  // namespace cia402::canopen
