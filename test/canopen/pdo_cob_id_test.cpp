// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// COB-IDs that a drive keeps to itself.
#include "canopen/pdo_configurator_fixture.h"

namespace cia402::canopen {
namespace {

using namespace test;
using ::testing::HasSubstr;

const char kReadOnlyCobId[] = "583 80 00 18 01 02 00 01 06";
const char kOtherCobId[] = "583 43 00 18 01 A5 01 00 00";  // 1A5h, valid

class PdoCobIdTest : public PdoConfiguratorTest {};

TEST_F(PdoCobIdTest, keeps_a_cob_id_that_the_drive_does_not_let_change) {
  peer.on(kReadCobId, kOtherCobId).on("603 23 00 18 01 A5 01 00 80", kReadOnlyCobId);
  allAsWanted();
  peer.replace(kReadCobId, kOtherCobId);
  EXPECT_EQ(run(wantedTpdo()), Status::done) << configurator->error();
  EXPECT_EQ(configurator->adoptedCobId(), 0x1A5);
}

TEST_F(PdoCobIdTest, keeps_the_drives_cob_id_where_only_another_one_is_refused) {
  allAsWanted();
  allWritesTaken();
  peer.replace(kReadCobId, kOtherCobId)
      .on("603 23 00 18 01 A5 01 00 80", kCobIdDone)
      .replace(kEnable, kReadOnlyCobId)
      .on("603 23 00 18 01 A5 01 00 00", kCobIdDone);
  EXPECT_EQ(run(wantedTpdo()), Status::done) << configurator->error();
  EXPECT_EQ(configurator->adoptedCobId(), 0x1A5);
}

TEST_F(PdoCobIdTest, a_pdo_that_the_drive_keeps_invalid_is_an_error) {
  allAsWanted();
  peer.replace(kReadCobId, kCobIdDisabled).on(kEnable, kReadOnlyCobId);
  EXPECT_EQ(run(wantedTpdo()), Status::failed);
  EXPECT_THAT(configurator->error(), HasSubstr("0x06010002"));
}

TEST_F(PdoCobIdTest, takes_the_drives_own_cob_id_where_none_is_configured) {
  allAsWanted();
  peer.replace(kReadCobId, kOtherCobId);
  PdoConfig wanted = wantedTpdo();
  wanted.cob_id = 0;
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_EQ(peer.take(), kReadAll) << "nothing is written";
  EXPECT_EQ(configurator->adoptedCobId(), 0x1A5);
}

TEST_F(PdoCobIdTest, refuses_an_own_cob_id_that_is_none) {
  PdoConfig wanted = wantedTpdo();
  wanted.cob_id = 0;
  peer.on(kReadCobId, "583 43 00 18 01 00 00 00 80");
  EXPECT_EQ(run(wanted), Status::failed);
  EXPECT_THAT(configurator->error(), HasSubstr("1800:01 is 0x80000000, which is none of 11 bits"));
  peer.replace(kReadCobId, "583 43 00 18 01 A5 01 00 20");  // bit 29: 29-bit identifier
  EXPECT_EQ(run(wanted), Status::failed);
}

TEST_F(PdoCobIdTest, allows_remote_frames_for_types_that_need_them) {
  allAsWanted();
  allWritesTaken();
  const char forbidden[] = "583 43 00 18 01 83 01 00 40";  // bit 30: no remote frames
  peer.replace(kReadCobId, {forbidden})
      .on(kReadCobId, kCobIdEnabled)
      .on("603 23 00 18 01 83 01 00 C0", kCobIdDone)
      .replace(kReadType, "583 4F 00 18 02 FD 00 00 00");  // 253
  PdoConfig wanted = wantedTpdo();
  wanted.transmission = 253;
  EXPECT_EQ(run(wanted), Status::done) << configurator->error();
  EXPECT_FALSE(configurator->adoptedCobId());
}

}  // namespace
}  // namespace cia402::canopen
