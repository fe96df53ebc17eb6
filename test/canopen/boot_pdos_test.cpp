// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// PDOs that a drive takes otherwise than configured, and what its process image makes of that.
#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using test::frame;
using test::kStatusword;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr ObjectId kActualPosition{0x6064, 0};
const char kAskTpdoCount[] = "603 40 00 1A 00 00 00 00 00";
const char kNoEntries[] = "583 4F 00 1A 00 00 00 00 00",
           kOneEntry[] = "583 4F 00 1A 00 01 00 00 00",
           kTwoEntries[] = "583 4F 00 1A 00 02 00 00 00";
const char kClearTpdo[] = "603 2F 00 1A 00 00 00 00 00";
const char kMapPosition[] = "603 23 00 1A 02 20 00 64 60";

/// TPDO 1 has no entries yet, and takes 6041:00 and 6064:00.
class BootPdosTest : public test::NodeFixture {
 protected:
  BootPdosTest() {
    peer.replace(kAskTpdoCount, kNoEntries);
    peer.on("603 23 00 18 01 83 01 00 80", "583 60 00 18 01 00 00 00 00");
    peer.on(kClearTpdo, "583 60 00 1A 00 00 00 00 00");
    peer.on("603 23 00 1A 01 10 00 41 60", "583 60 00 1A 01 00 00 00 00");
    peer.on(kMapPosition, "583 60 00 1A 02 00 00 00 00");
    for (const char* count : {"603 2F 00 1A 00 01 00 00 00", "603 2F 00 1A 00 02 00 00 00"}) {
      peer.on(count, "583 60 00 1A 00 00 00 00 00");
    }
    peer.on("603 23 00 18 01 83 01 00 00", "583 60 00 18 01 00 00 00 00");
  }
  bool leftOut() {
    const PdoImage& image = node->image();
    return image.inputLeftOut(image.inputSlot(kActualPosition));
  }
  fieldbus::ProcessValue position() {
    return node->image().input(node->image().inputSlot(kActualPosition));
  }
};

TEST_F(BootPdosTest, an_entry_that_the_drive_does_not_map_is_not_expected_in_its_frames) {
  config.pdos[1].entries[1].optional = true;
  peer.on(kAskTpdoCount, kOneEntry);
  peer.replace(kMapPosition, "583 80 00 1A 02 41 00 04 06");
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("6064:00 position")));
  EXPECT_TRUE(leftOut());
  node->receiveTpdo(0, frame("183 37 02"), now);
  EXPECT_EQ(node->image().input(node->image().inputSlot(kStatusword)).raw, 0x0237U);
  EXPECT_FALSE(position().valid);
}

TEST_F(BootPdosTest, an_entry_that_was_there_for_the_room_only_is_no_cause_for_a_warning) {
  config.pdos[1].entries[1].optional = config.pdos[1].entries[1].if_room = true;
  peer.on(kAskTpdoCount, kOneEntry);
  peer.replace(kMapPosition, "583 80 00 1A 02 42 00 04 06");
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(node->notes(), IsEmpty());
  EXPECT_THAT(node->remarks(), ElementsAre("the drive does not take 6064:00 position into a TPDO"));
  EXPECT_TRUE(leftOut());
}

TEST_F(BootPdosTest, an_entry_that_was_left_out_is_there_again_once_the_drive_takes_it) {
  config.pdos[1].entries[1].optional = true;
  peer.on(kAskTpdoCount, kOneEntry);
  peer.replace(kMapPosition, "583 80 00 1A 02 41 00 04 06");
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  ASSERT_TRUE(leftOut());
  peer.replace(kAskTpdoCount, kOneEntry).on(kAskTpdoCount, kTwoEntries);  // another firmware by now
  peer.replace(kMapPosition, "583 60 00 1A 02 00 00 00 00");
  hear("703 00");
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(node->notes(), IsEmpty());
  EXPECT_FALSE(leftOut());
  node->receiveTpdo(0, frame("183 37 02 78 56 34 12"), now);
  EXPECT_EQ(position().raw, 0x12345678U);
}

TEST_F(BootPdosTest, a_fixed_number_of_entries_is_the_room_that_there_is) {
  config.fixed_map_entries = 1;
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("it has 2 entries, the drive has room for 1"));
}

TEST_F(BootPdosTest, a_number_of_entries_that_is_read_only_is_excused_where_the_profile_says_so) {
  peer.on(kAskTpdoCount, kTwoEntries);  // the entries that were written count by themselves
  peer.replace(kClearTpdo, "583 80 00 1A 00 02 00 01 06");
  config.map_count_may_be_read_only = true;
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_FALSE(sentLine("603 2F 00 1A 00 02 00 00 00"));
}

}  // namespace
}  // namespace cia402::canopen
