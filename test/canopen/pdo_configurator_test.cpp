// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/pdo_configurator_fixture.h"

namespace cia402::canopen {
namespace {

using namespace test;
using ::testing::HasSubstr;

TEST_F(PdoConfiguratorTest, writes_nothing_when_everything_is_as_wanted) {
  allAsWanted();
  EXPECT_EQ(run(wantedTpdo()), Status::done);
  EXPECT_EQ(peer.take(), kReadAll);
  EXPECT_FALSE(configurator->changed());
}

TEST_F(PdoConfiguratorTest, remaps_by_the_book_and_reads_back) {
  peer.on(kReadCobId, kCobIdEnabled).on(kReadType, kType255).on(kReadCount, kCount0);
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo()), Status::done) << configurator->error();
  Lines expected{kReadCobId, kReadType, kReadInhibit, kReadTimer, kReadCount};
  for (const char* line :
       {kDisable, kClearMap, kWriteEntry1, kWriteEntry2, kWriteCount, kWriteType, kEnable}) {
    expected.push_back(line);
  }
  expected.insert(expected.end(), kReadAll.begin(), kReadAll.end());
  EXPECT_EQ(peer.take(), expected);
  EXPECT_TRUE(configurator->changed());
}

TEST_F(PdoConfiguratorTest, a_wrong_entry_alone_makes_it_remap) {
  peer.on(kReadEntry2, "583 43 00 1A 02 20 00 6C 60");
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo()), Status::done) << configurator->error();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 7, sent.begin() + 13),
            (Lines{kDisable, kClearMap, kWriteEntry1, kWriteEntry2, kWriteCount, kEnable}));
}

TEST_F(PdoConfiguratorTest, leaves_the_map_alone_when_only_the_transmission_type_differs) {
  peer.on(kReadType, kType255);
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo()), Status::done) << configurator->error();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 7, sent.begin() + 10), (Lines{kDisable, kWriteType, kEnable}));
}

TEST_F(PdoConfiguratorTest, does_not_disable_what_is_disabled_already) {
  peer.on(kReadCobId, kCobIdDisabled);
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo()), Status::done) << configurator->error();
  const Lines sent = peer.take();
  ASSERT_EQ(sent.size(), 15U);
  EXPECT_EQ(sent[7], kEnable);
}

TEST_F(PdoConfiguratorTest, keeps_the_bit_that_says_whether_remote_frames_are_allowed) {
  peer.on(kReadCobId, "583 43 00 18 01 83 01 00 C0")
      .on(kReadCobId, "583 43 00 18 01 83 01 00 40")
      .on("603 23 00 18 01 83 01 00 40", kCobIdDone);
  allAsWanted();
  EXPECT_EQ(run(wantedTpdo()), Status::done) << configurator->error();
  EXPECT_EQ(peer.take()[7], "603 23 00 18 01 83 01 00 40");
}

TEST_F(PdoConfiguratorTest, changes_the_cob_id_only_while_the_pdo_is_invalid) {
  // It is enabled on 185h.
  peer.on(kReadCobId, "583 43 00 18 01 85 01 00 00").on("603 23 00 18 01 85 01 00 80", kCobIdDone);
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo()), Status::done) << configurator->error();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 7, sent.begin() + 9),
            (Lines{"603 23 00 18 01 85 01 00 80", kEnable}));
}

TEST_F(PdoConfiguratorTest, writes_inhibit_time_and_event_timer) {
  PdoConfig wanted = wantedTpdo();
  wanted.inhibit = 100;
  wanted.event_timer = 20;
  peer.on(kReadInhibit, kInhibit0)
      .on(kReadInhibit, "583 4B 00 18 03 64 00 00 00")
      .on(kReadTimer, kTimer0)
      .on(kReadTimer, "583 4B 00 18 05 14 00 00 00")
      .on("603 2B 00 18 03 64 00 00 00", "583 60 00 18 03 00 00 00 00")
      .on("603 2B 00 18 05 14 00 00 00", "583 60 00 18 05 00 00 00 00");
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
}

TEST_F(PdoConfiguratorTest, tolerates_missing_timers_only_if_none_are_wanted) {
  peer.on(kReadInhibit, "583 80 00 18 03 11 00 09 06")
      .on(kReadTimer, "583 80 00 18 05 11 00 09 06");
  peer.on(kReadCobId, kCobIdEnabled)
      .on(kReadType, kType1)
      .on(kReadCount, kCount2)
      .on(kReadEntry1, kEntry1)
      .on(kReadEntry2, kEntry2);
  EXPECT_EQ(run(wantedTpdo()), Status::done) << configurator->error();
  PdoConfig wanted = wantedTpdo();
  wanted.event_timer = 20;
  EXPECT_EQ(run(wanted), Status::failed);
  EXPECT_EQ(configurator->error(),
            "TPDO 1: reading 1800:05 event timer of TPDO 1: the drive refused: 0x06090011 "
            "(sub-index does not exist)");
}

TEST_F(PdoConfiguratorTest, an_rpdo_lives_at_1400h_and_1600h_and_has_no_inhibit_time) {
  PdoConfig wanted;
  wanted.direction = PdoDirection::rpdo;
  wanted.number = 2;
  wanted.cob_id = 0x303;
  wanted.entries = {{{0x6040, 0}, 16, "controlword"}};
  peer.on("603 40 01 14 01 00 00 00 00", "583 43 01 14 01 03 03 00 00")
      .on("603 40 01 14 02 00 00 00 00", "583 4F 01 14 02 01 00 00 00")
      .on("603 40 01 14 05 00 00 00 00", "583 4B 01 14 05 00 00 00 00")
      .on("603 40 01 16 00 00 00 00 00", "583 4F 01 16 00 01 00 00 00")
      .on("603 40 01 16 01 00 00 00 00", "583 43 01 16 01 10 00 40 60");
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_EQ(peer.take().size(), 5U);
}

TEST_F(PdoConfiguratorTest, fails_with_the_object_when_the_drive_refuses_an_entry) {
  peer.on(kReadCount, kCount0)
      .on(kDisable, kCobIdDone)
      .on(kClearMap, kCountDone)
      .on(kWriteEntry1, "583 80 00 1A 01 41 00 04 06");
  allAsWanted();
  EXPECT_EQ(run(wantedTpdo()), Status::failed);
  EXPECT_EQ(configurator->error(),
            "TPDO 1: writing 0x60410010 to 1A00:01 entry 1 (6041:00 statusword) of TPDO 1: the "
            "drive refused: 0x06040041 (object cannot be mapped to the PDO)");
}

TEST_F(PdoConfiguratorTest, fails_when_the_drive_takes_everything_but_reads_back_otherwise) {
  peer.on(kReadType, kType255);
  peer.on(kReadType, kType255);
  allWritesTaken();
  peer.on(kReadCobId, kCobIdEnabled)
      .on(kReadInhibit, kInhibit0)
      .on(kReadTimer, kTimer0)
      .on(kReadCount, kCount2)
      .on(kReadEntry1, kEntry1)
      .on(kReadEntry2, kEntry2);
  EXPECT_EQ(run(wantedTpdo()), Status::failed);
  EXPECT_THAT(configurator->error(),
              HasSubstr("the drive took all writes, but 1800:02 is 255, wanted is 1"));
}

const char kReadOnly[] = "583 80 00 1A 00 02 00 01 06";

TEST_F(PdoConfiguratorTest, a_read_only_number_of_entries_is_an_error_unless_the_profile_says_so) {
  peer.on(kReadCount, kCount0).on(kDisable, kCobIdDone).on(kClearMap, kReadOnly);
  allAsWanted();
  EXPECT_EQ(run(wantedTpdo()), Status::failed);
  EXPECT_THAT(configurator->error(), HasSubstr("0x06010002"));
  EXPECT_THAT(configurator->error(), HasSubstr("profile"));
}

TEST_F(PdoConfiguratorTest, with_a_read_only_number_of_entries_the_map_may_take_nevertheless) {
  PdoConfigurator::Options options;
  options.count_may_be_read_only = true;
  peer.on(kReadCount, kCount0).on(kClearMap, kReadOnly);
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo(), options), Status::done) << configurator->error();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 5, sent.begin() + 10),
            (Lines{kDisable, kClearMap, kWriteEntry1, kWriteEntry2, kEnable}));
}

TEST_F(PdoConfiguratorTest, with_a_read_only_number_of_entries_a_map_that_did_not_take_is_told) {
  PdoConfigurator::Options options;
  options.count_may_be_read_only = true;
  peer.on(kReadCount, kCount0).on(kClearMap, kReadOnly);
  peer.on(kReadCount, kCount0);
  peer.on(kReadCobId, kCobIdEnabled)
      .on(kReadType, kType1)
      .on(kReadInhibit, kInhibit0)
      .on(kReadTimer, kTimer0);
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo(), options), Status::failed);
  EXPECT_EQ(configurator->error(),
            "TPDO 1: the drive refuses to change the number of mapped objects (1A00:00 is "
            "read-only), and 1A00:00 is 0, wanted is 2; choose a mapping that the drive can hold");
}

TEST_F(PdoConfiguratorTest, the_quirk_excuses_no_other_object) {
  PdoConfigurator::Options options;
  options.count_may_be_read_only = true;
  peer.on(kReadCount, kCount0)
      .on(kDisable, kCobIdDone)
      .on(kClearMap, kReadOnly)
      .on(kWriteEntry1, "583 80 00 1A 01 02 00 01 06");
  allAsWanted();
  EXPECT_EQ(run(wantedTpdo(), options), Status::failed);
}

// Curtis: sub-index 0 is always the same, what is not used is 0.
PdoConfigurator::Options threeEntries() {
  PdoConfigurator::Options options;
  options.fixed_entries = 3;
  return options;
}

const char kReadEntry3[] = "603 40 00 1A 03 00 00 00 00";
const char kCount3[] = "583 4F 00 1A 00 03 00 00 00";
const char kNoEntry2[] = "583 43 00 1A 02 00 00 00 00";
const char kNoEntry3[] = "583 43 00 1A 03 00 00 00 00";
const char kClearEntry1[] = "603 23 00 1A 01 00 00 00 00";
const char kClearEntry2[] = "603 23 00 1A 02 00 00 00 00";
const char kClearEntry3[] = "603 23 00 1A 03 00 00 00 00";

TEST_F(PdoConfiguratorTest, fillers_at_the_end_of_a_fixed_number_of_entries_are_no_objects) {
  peer.on(kReadCount, kCount3).on(kReadEntry3, kNoEntry3);
  allAsWanted();
  EXPECT_EQ(run(wantedTpdo(), threeEntries()), Status::done) << configurator->error();
  EXPECT_FALSE(configurator->changed());
}

TEST_F(PdoConfiguratorTest, a_fixed_number_of_entries_is_filled_and_never_written) {
  peer.on(kReadCount, kCount3)
      .on(kReadCount, kCount3)
      .on(kReadEntry2, "583 43 00 1A 02 08 00 61 60")
      .on(kReadEntry3, "583 43 00 1A 03 10 00 77 60")
      .on(kReadEntry3, kNoEntry3)
      .on(kClearEntry1, kEntry1Done)
      .on(kClearEntry2, kEntry2Done)
      .on(kClearEntry3, "583 60 00 1A 03 00 00 00 00");
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo(), threeEntries()), Status::done) << configurator->error();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 8, sent.begin() + 15),
            (Lines{kDisable, kClearEntry3, kClearEntry2, kClearEntry1, kWriteEntry1, kWriteEntry2,
                   kEnable}));
}

TEST_F(PdoConfiguratorTest, a_gap_before_the_last_entry_is_no_filler) {
  peer.on(kReadCount, kCount3)
      .on(kReadEntry2, kNoEntry2)
      .on(kReadEntry3, "583 43 00 1A 03 20 00 64 60");
  allAsWanted();
  EXPECT_EQ(run(wantedTpdo(), threeEntries()), Status::running);
  EXPECT_EQ(peer.take().back(), kDisable);
}

TEST_F(PdoConfiguratorTest, a_fixed_number_of_entries_that_the_drive_does_not_have_is_told) {
  allAsWanted();
  EXPECT_EQ(run(wantedTpdo(), threeEntries()), Status::failed);
  EXPECT_EQ(configurator->error(),
            "TPDO 1: 1A00:00 is 2, but the profile says that it is always 3 "
            "(pdo_rules/fixed_entries)");
}

TEST_F(PdoConfiguratorTest, more_entries_than_there_are_places_are_refused_before_a_frame) {
  PdoConfigurator::Options one;
  one.fixed_entries = 1;
  EXPECT_EQ(run(wantedTpdo(), one), Status::failed);
  EXPECT_EQ(configurator->error(), "TPDO 1: it has 2 entries, the drive has room for 1");
  EXPECT_TRUE(peer.take().empty());
}

TEST_F(PdoConfiguratorTest, an_unwanted_pdo_is_made_invalid_and_nothing_else) {
  PdoConfig unwanted = wantedTpdo();
  unwanted.enabled = false;
  peer.on(kReadCobId, kCobIdEnabled).on(kReadCobId, kCobIdDisabled).on(kDisable, kCobIdDone);
  EXPECT_EQ(run(unwanted), Status::done);
  EXPECT_EQ(peer.take(), (Lines{kReadCobId, kDisable, kReadCobId}));
}

TEST_F(PdoConfiguratorTest, an_unwanted_pdo_that_is_invalid_or_missing_is_left_alone) {
  PdoConfig unwanted = wantedTpdo();
  unwanted.enabled = false;
  PdoConfigurator::Options options;
  options.may_be_missing = true;
  peer.on(kReadCobId, kCobIdDisabled).on(kReadCobId, "583 80 00 18 01 00 00 02 06");
  EXPECT_EQ(run(unwanted, options), Status::done);
  EXPECT_EQ(run(unwanted, options), Status::done);
  EXPECT_EQ(peer.take(), (Lines{kReadCobId, kReadCobId}));
}

TEST_F(PdoConfiguratorTest, a_wanted_pdo_that_the_drive_does_not_have_is_an_error) {
  peer.on(kReadCobId, "583 80 00 18 01 00 00 02 06");
  EXPECT_EQ(run(wantedTpdo()), Status::failed);
  EXPECT_THAT(configurator->error(), HasSubstr("the drive has no such PDO"));
  EXPECT_FALSE(configurator->timedOut());
}

TEST_F(PdoConfiguratorTest, refuses_more_than_64_bits_before_it_touches_the_drive) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries.push_back({{0x606C, 0}, 32, "velocity"});
  EXPECT_EQ(run(wanted), Status::failed);
  EXPECT_EQ(configurator->error(), "TPDO 1: its entries have 80 bits, 64 fit in a PDO");
  EXPECT_TRUE(peer.take().empty());
}

TEST_F(PdoConfiguratorTest, says_when_the_drive_stopped_answering) {
  EXPECT_EQ(run(wantedTpdo()), Status::running);
  now += std::chrono::seconds(1);
  client.tick(now);
  EXPECT_EQ(configurator->advance(), Status::failed);
  EXPECT_TRUE(configurator->timedOut());
  EXPECT_THAT(configurator->error(), HasSubstr("no answer within 500 ms"));
}

}  // namespace
}  // namespace cia402::canopen
