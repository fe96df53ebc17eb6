// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What is worth telling of a boot: of the last one, once, also where it failed.
#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using test::kAskDeviceType;
using test::Lines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A drive that cannot watch the master: one note.
class BootNotesTest : public test::NodeFixture {
 protected:
  BootNotesTest() { peer.replace("603 23 16 10 01 2C 01 7F 00", "583 80 16 10 01 00 00 02 06"); }
  void expectOneNote() {
    EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("cannot notice a dead master")));
  }
};

TEST_F(BootNotesTest, do_not_pile_up_from_boot_to_boot) {
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  expectOneNote();
  hear("703 00");
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  expectOneNote();
}

TEST_F(BootNotesTest, of_the_boot_before_are_gone_when_the_next_begins) {
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  peer.forget(kAskDeviceType);
  hear("703 00");
  ASSERT_EQ(node->health(), Health::booting);
  EXPECT_THAT(node->notes(), IsEmpty());
}

TEST_F(BootNotesTest, are_told_once_where_a_drive_that_was_stopped_begins_again) {
  const char kAskSyncId[] = "603 40 05 10 00 00 00 00 00";
  peer.forget(kAskSyncId);
  boot();
  pass(milliseconds(100));
  hear("703 04");
  peer.on(kAskSyncId, "583 43 05 10 00 80 00 00 00");
  hear("703 7F");
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  expectOneNote();
}

TEST_F(BootNotesTest, are_told_of_a_boot_that_failed_too) {
  peer.replace("603 40 00 18 01 00 00 00 00", "583 80 00 18 01 00 00 02 06");
  boot();
  ASSERT_EQ(node->health(), Health::failed);
  expectOneNote();
}

}  // namespace
}  // namespace cia402::canopen
