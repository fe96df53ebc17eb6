// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Numbers and sizes at their limits, and drives that answer for a mapping otherwise than most.
#include "canopen/pdo_configurator_fixture.h"

namespace cia402::canopen {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class PdoConfiguratorEdges : public PdoConfiguratorTest {
 protected:
  static PdoEntry entry(std::uint16_t index, std::uint8_t bits, bool optional) {
    PdoEntry result{{index, 0}, bits, ""};
    result.optional = optional;
    return result;
  }
  /// All communication parameters of TPDO 1 are as wanted.
  void parametersAsWanted() {
    peer.on(kReadCobId, kCobIdEnabled).on(kReadType, kType1);
    peer.on(kReadInhibit, kInhibit0).on(kReadTimer, kTimer0);
  }
  /// "603 2F 00 1A 00 02 00 00 00" for 2.
  static std::string writeCount(int count) {
    return "603 2F 00 1A 00 0" + std::to_string(count) + " 00 00 00";
  }
  static std::string count(int count) {
    return "583 4F 00 1A 00 0" + std::to_string(count) + " 00 00 00";
  }
  std::vector<ObjectId> leftOut() const {
    std::vector<ObjectId> objects;
    for (const PdoEntry& left : configurator->leftOut()) objects.push_back(left.object);
    return objects;
  }
};

TEST_F(PdoConfiguratorEdges, there_are_512_pdos_of_each_direction) {
  PdoConfig wanted = wantedTpdo();
  wanted.number = 512;
  EXPECT_EQ(run(wanted), Status::running);
  EXPECT_EQ(peer.take(), Lines{"603 40 FF 19 01 00 00 00 00"});  // 19FFh
  client.cancelAll("enough");
  client.serverRestarted();
  peer.take();
  for (const unsigned number : {0U, 513U}) {
    wanted.number = number;
    EXPECT_EQ(run(wanted), Status::failed) << number;
    EXPECT_THAT(configurator->error(), HasSubstr("1..512"));
    EXPECT_TRUE(peer.take().empty());
  }
}

TEST_F(PdoConfiguratorEdges, a_pdo_may_have_64_bits) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries[0].bits = 32;
  EXPECT_EQ(run(wanted), Status::running);
  EXPECT_EQ(peer.take(), Lines{kReadCobId});
}

TEST_F(PdoConfiguratorEdges, each_parameter_that_differs_is_written_in_order) {
  PdoConfig wanted = wantedTpdo();
  wanted.inhibit = 100;
  wanted.event_timer = 20;
  const char kWriteInhibit[] = "603 2B 00 18 03 64 00 00 00";
  const char kWriteTimer[] = "603 2B 00 18 05 14 00 00 00";
  peer.on(kReadType, kType255)
      .on(kReadInhibit, kInhibit0)
      .on(kReadInhibit, "583 4B 00 18 03 64 00 00 00")
      .on(kReadTimer, kTimer0)
      .on(kReadTimer, "583 4B 00 18 05 14 00 00 00")
      .on(kWriteInhibit, "583 60 00 18 03 00 00 00 00")
      .on(kWriteTimer, "583 60 00 18 05 00 00 00 00");
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 7, sent.begin() + 12),
            (Lines{kDisable, kWriteType, kWriteInhibit, kWriteTimer, kEnable}));
}

TEST_F(PdoConfiguratorEdges, parameters_are_written_where_the_number_of_entries_is_not) {
  PdoConfigurator::Options options;
  options.count_may_be_read_only = true;
  peer.on(kReadType, kType255).on(kReadCount, kCount0);
  peer.on(kClearMap, "583 80 00 1A 00 02 00 01 06");
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo(), options), Status::done) << configurator->error();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 5, sent.begin() + 11),
            (Lines{kDisable, kClearMap, kWriteEntry1, kWriteEntry2, kWriteType, kEnable}));
}

TEST_F(PdoConfiguratorEdges, a_tpdo_that_is_asked_for_must_allow_remote_frames) {
  PdoConfig wanted = wantedTpdo();
  wanted.cob_id = 0x184;
  wanted.transmission = 252;
  const char kType252[] = "583 4F 00 18 02 FC 00 00 00";
  const char kAllow[] = "603 23 00 18 01 84 01 00 00";
  peer.on(kReadCobId, "583 43 00 18 01 84 01 00 C0")  // invalid, no remote frames
      .on(kReadCobId, "583 43 00 18 01 84 01 00 00")
      .on(kReadType, kType252)
      .on(kReadInhibit, kInhibit0)
      .on(kReadTimer, kTimer0)
      .on(kReadCount, kCount2)
      .on(kReadEntry1, kEntry1)
      .on(kReadEntry2, kEntry2)
      .on(kAllow, kCobIdDone);
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_EQ(peer.take()[7], kAllow);
}

TEST_F(PdoConfiguratorEdges, a_pdo_without_entries_is_cleared_and_its_parameters_are_written) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries.clear();
  peer.on(kReadType, kType255).on(kReadCount, kCount2).on(kReadCount, kCount0);
  peer.on(kReadCobId, kCobIdEnabled).on(kReadType, kType1);
  peer.on(kReadInhibit, kInhibit0).on(kReadTimer, kTimer0);
  allWritesTaken();
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 5, sent.begin() + 9),
            (Lines{kDisable, kClearMap, kWriteType, kEnable}));
}

TEST_F(PdoConfiguratorEdges, a_fixed_number_of_places_that_are_all_free_is_filled) {
  PdoConfigurator::Options options;
  options.fixed_entries = 2;
  parametersAsWanted();
  peer.on(kReadCount, kCount2);
  peer.on(kReadEntry1, "583 43 00 1A 01 00 00 00 00").on(kReadEntry1, kEntry1);
  peer.on(kReadEntry2, "583 43 00 1A 02 00 00 00 00").on(kReadEntry2, kEntry2);
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo(), options), Status::done) << configurator->error();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 7, sent.begin() + 11),
            (Lines{kDisable, kWriteEntry1, kWriteEntry2, kEnable}));
}

TEST_F(PdoConfiguratorEdges, a_cob_id_that_is_not_kept_is_told_with_both_numbers) {
  parametersAsWanted();
  peer.replace(kReadCobId, "583 43 00 18 01 85 01 00 00");  // 185h, whatever is written
  peer.on("603 23 00 18 01 85 01 00 80", kCobIdDone);
  peer.on(kReadCount, kCount2).on(kReadEntry1, kEntry1).on(kReadEntry2, kEntry2);
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo()), Status::failed);
  EXPECT_THAT(configurator->error(),
              HasSubstr("1800:01 is 0x00000185, wanted is 0x00000183; choose"));
}

TEST_F(PdoConfiguratorEdges, an_unwanted_pdo_that_stays_valid_is_told) {
  PdoConfig unwanted = wantedTpdo();
  unwanted.enabled = false;
  peer.on(kReadCobId, kCobIdEnabled).on(kDisable, kCobIdDone);
  EXPECT_EQ(run(unwanted), Status::failed);
  EXPECT_EQ(configurator->error(),
            "TPDO 1: the drive did not disable it: COB-ID is still 0x00000183");
  EXPECT_EQ(peer.take(), (Lines{kReadCobId, kDisable, kReadCobId}));
}

TEST_F(PdoConfiguratorEdges, a_mapping_that_is_refused_as_a_whole_is_told_with_all_its_objects) {
  peer.on(kReadCount, kCount0).on(kWriteCount, "583 80 00 1A 00 41 00 04 06");
  allAsWanted();
  allWritesTaken();
  EXPECT_EQ(run(wantedTpdo()), Status::failed);
  EXPECT_THAT(configurator->error(),
              HasSubstr("; one of these cannot be mapped: entry 1 (6041:00 statusword), entry 2 "
                        "(6064:00 position)"));
  EXPECT_EQ(configurator->abortCode(), 0x06040041U);
}

TEST_F(PdoConfiguratorEdges, silence_is_no_abort_code) {
  run(wantedTpdo());
  now += std::chrono::seconds(1);
  client.tick(now);
  EXPECT_EQ(configurator->advance(), Status::failed);
  EXPECT_EQ(configurator->abortCode(), 0U);
}

// What is there for the room only (if_room) goes where the drive refuses the PDO as a whole.
TEST_F(PdoConfiguratorEdges, what_follows_an_entry_that_goes_at_the_end_is_mapped_anew) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries[0].optional = wanted.entries[0].if_room = true;
  const char kPositionFirst[] = "603 23 00 1A 01 20 00 64 60";
  parametersAsWanted();
  peer.on(kReadCount, kCount0).on(kReadCount, {count(1)});
  peer.on(kReadEntry1, "583 43 00 1A 01 20 00 64 60");
  peer.on(kWriteCount, "583 80 00 1A 00 42 00 04 06");
  peer.on(kPositionFirst, kEntry1Done).on(writeCount(1), kCountDone);
  allWritesTaken();
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_THAT(leftOut(), ElementsAre(ObjectId{0x6041, 0}));
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin() + 5, sent.begin() + 14),
            (Lines{kDisable, kClearMap, kWriteEntry1, kWriteEntry2, kWriteCount, kClearMap,
                   kPositionFirst, writeCount(1), kEnable}));
}

TEST_F(PdoConfiguratorEdges, a_pdo_whose_last_entry_goes_at_the_end_stays_invalid) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries.pop_back();
  wanted.entries[0].optional = wanted.entries[0].if_room = true;
  peer.on(kReadCobId, kCobIdEnabled).on(kReadCobId, kCobIdDisabled);
  peer.on(kReadType, kType1).on(kReadInhibit, kInhibit0).on(kReadTimer, kTimer0);
  peer.on(kReadCount, kCount0).on(writeCount(1), "583 80 00 1A 00 42 00 04 06");
  allWritesTaken();
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_THAT(leftOut(), ElementsAre(ObjectId{0x6041, 0}));
  EXPECT_EQ(peer.take().back(), kReadCobId) << "nothing was written behind it";
}

// Drives that judge all entries at the end: who is missing is found by reading.
TEST_F(PdoConfiguratorEdges, only_optional_entries_are_looked_for_by_reading) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries = {entry(0x6064, 32, true), entry(0x6041, 16, false), entry(0x6061, 8, true)};
  parametersAsWanted();
  peer.on(kReadCount, kCount0).on(kReadCount, {count(2)});
  peer.on(kReadEntry1, "583 43 00 1A 01 20 00 64 60")
      .on(kReadEntry2, "583 43 00 1A 02 10 00 41 60");
  peer.on("603 23 00 1A 01 20 00 64 60", kEntry1Done)
      .on("603 23 00 1A 02 10 00 41 60", kEntry2Done);
  peer.on("603 23 00 1A 03 08 00 61 60", "583 60 00 1A 03 00 00 00 00");
  peer.on(writeCount(3), "583 80 00 1A 00 41 00 04 06");
  peer.on("603 40 64 60 00 00 00 00 00", "583 43 64 60 00 10 00 00 00");
  peer.on("603 40 41 60 00 00 00 00 00", "583 80 41 60 00 00 00 02 06");
  peer.on("603 40 61 60 00 00 00 00 00", "583 80 61 60 00 00 00 02 06");
  allWritesTaken();
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_THAT(leftOut(), ElementsAre(ObjectId{0x6061, 0})) << "the statusword is not optional";
}

TEST_F(PdoConfiguratorEdges, one_that_was_refused_before_does_not_explain_a_refusal_at_the_end) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries = {entry(0x6041, 16, false), entry(0x6064, 32, true), entry(0x6061, 8, true)};
  parametersAsWanted();
  peer.on(kReadCount, kCount0).on(kReadCount, {count(1)});
  peer.on(kReadEntry1, kEntry1);
  peer.on("603 23 00 1A 02 20 00 64 60", "583 80 00 1A 02 41 00 04 06");
  peer.on("603 23 00 1A 02 08 00 61 60", kEntry2Done);
  peer.on(writeCount(2), "583 80 00 1A 00 41 00 04 06").on(writeCount(1), kCountDone);
  peer.on("603 40 61 60 00 00 00 00 00", "583 4F 61 60 00 08 00 00 00");  // it has that
  allWritesTaken();
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_THAT(leftOut(), ElementsAre(ObjectId{0x6064, 0}, ObjectId{0x6061, 0}));
}

TEST_F(PdoConfiguratorEdges, the_only_optional_entry_goes_though_it_is_the_first) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries[0].optional = true;
  parametersAsWanted();
  peer.on(kReadCount, kCount0).on(kReadCount, {count(1)});
  peer.on(kReadEntry1, "583 43 00 1A 01 20 00 64 60");
  peer.on(kWriteCount, "583 80 00 1A 00 41 00 04 06").on(writeCount(1), kCountDone);
  peer.on("603 23 00 1A 01 20 00 64 60", kEntry1Done);
  peer.on("603 40 41 60 00 00 00 00 00", "583 4B 41 60 00 50 02 00 00");  // it has that
  allWritesTaken();
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_THAT(leftOut(), ElementsAre(ObjectId{0x6041, 0}));
}

TEST_F(PdoConfiguratorEdges, all_optional_entries_are_looked_for_before_one_goes) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries = {entry(0x6041, 16, true), entry(0x6064, 32, true), entry(0x6061, 8, true)};
  parametersAsWanted();
  peer.on(kReadCount, kCount0).on(kReadCount, {count(2)});
  peer.on(kReadEntry1, kEntry1).on(kReadEntry2, "583 43 00 1A 02 08 00 61 60");
  peer.on("603 23 00 1A 03 08 00 61 60", "583 60 00 1A 03 00 00 00 00");
  peer.on("603 23 00 1A 02 08 00 61 60", kEntry2Done);
  peer.on(writeCount(3), "583 80 00 1A 00 41 00 04 06");
  peer.on("603 40 41 60 00 00 00 00 00", "583 4B 41 60 00 50 02 00 00");
  peer.on("603 40 64 60 00 00 00 00 00", "583 80 64 60 00 00 00 02 06");
  peer.on("603 40 61 60 00 00 00 00 00", "583 4F 61 60 00 08 00 00 00");
  allWritesTaken();
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_THAT(leftOut(), ElementsAre(ObjectId{0x6064, 0}));
}

TEST_F(PdoConfiguratorEdges, a_pdo_whose_only_entry_is_found_missing_at_the_end_stays_invalid) {
  PdoConfig wanted = wantedTpdo();
  wanted.entries.pop_back();
  wanted.entries[0].optional = true;
  peer.on(kReadCobId, kCobIdEnabled).on(kReadCobId, kCobIdDisabled);
  peer.on(kReadType, kType1).on(kReadInhibit, kInhibit0).on(kReadTimer, kTimer0);
  peer.on(kReadCount, kCount0).on(writeCount(1), "583 80 00 1A 00 41 00 04 06");
  peer.on("603 40 41 60 00 00 00 00 00", "583 80 41 60 00 00 00 02 06");
  allWritesTaken();
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_THAT(leftOut(), ElementsAre(ObjectId{0x6041, 0}));
  EXPECT_EQ(peer.take().back(), kReadCobId);
}

}  // namespace
}  // namespace cia402::canopen
