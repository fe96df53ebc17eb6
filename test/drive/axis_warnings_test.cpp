// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Warnings of the drive (statusword bit 7), by what follows from them, and those of the driver.
#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;

TEST(Axis, AWarningStopsOnlyWhereTheProfileSaysSo) {
  Bench calm;
  ASSERT_TRUE(calm.boot());
  ASSERT_TRUE(calm.enable());
  calm.drive.warning = true;
  calm.run(milliseconds(40));
  EXPECT_TRUE(calm.axis.state().warning);
  EXPECT_TRUE(calm.axis.state().ready_for_motion);

  DriveProfile profile = testProfile();
  profile.warning_stops = true;
  Bench strict(testConfig(profile));
  ASSERT_TRUE(strict.boot());
  ASSERT_TRUE(strict.enable());
  strict.drive.warning = true;
  strict.run(milliseconds(40));
  EXPECT_FALSE(strict.axis.state().ready_for_motion);
  EXPECT_NE(strict.drive.state, FakeDrive::S::enabled);
  EXPECT_THAT(strict.axis.notice(), HasSubstr("statusword bit 7"));
}

TEST(Axis, AWarningThatStopsTheDriveIsAFaultWhateverOthersAre) {
  DriveProfile profile = testProfile();
  profile.warnings[0x5003] = {"hot", "", "", WarningText::Reaction::stops};
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.error = 0x5002;
  bench.drive.warning = true;
  bench.run(milliseconds(40));
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
  bench.drive.error = 0x5003;
  bench.run(milliseconds(40));
  EXPECT_FALSE(bench.axis.state().ready_for_motion);
  EXPECT_THAT(bench.axis.notice(), HasSubstr("which makes it stop like a fault"));
}

/// 0x5001 holds the motor, 0x5002 only tells; others stop the drive like a fault.
DriveProfile warned() {
  DriveProfile profile = testProfile();
  profile.warning_stops = true;
  profile.warnings[0x5001] = {"stalled", "load", "less of it", WarningText::Reaction::holds};
  profile.warnings[0x5002] = {"warm", "", "", WarningText::Reaction::goes_on};
  return profile;
}

TEST(Axis, AWarningThatOnlyTellsStopsNothing) {
  Bench bench(testConfig(warned()));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.error = 0x5002;
  bench.drive.warning = true;
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
  EXPECT_THAT(bench.axis.faultText(), HasSubstr("warning 0x5002 warm"));
  bench.drive.error = 0x5003;
  bench.run(milliseconds(100));
  EXPECT_FALSE(bench.axis.state().ready_for_motion) << "this one is not known";
}

TEST(Axis, AWarningThatHoldsTheMotorHaltsTheAxisOnce) {
  Bench bench(testConfig(warned()));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.error = 0x5001;
  bench.drive.warning = true;
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.axis.state().halted);
  EXPECT_EQ(bench.drive.state, FakeDrive::S::enabled) << "it holds the motor by itself";
  EXPECT_EQ(bench.axis.notice(),
            "shoulder (node 3): warning 0x5001 stalled: load; less of it; the drive holds the "
            "motor, and the axis is halted, so that it does not move on when the warning ends: "
            "enable releases it");
  const std::uint32_t notices = bench.axis.noticeCount();
  EXPECT_TRUE(bench.perform(ProcedureKind::enable).success) << "to drive off what holds it";
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
  EXPECT_EQ(bench.axis.noticeCount(), notices);
  bench.drive.warning = false;
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
  bench.drive.warning = true;
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.axis.state().halted) << "it came anew";
}

TEST(Axis, AWarningThatStoodBeforeEnablingDoesNotHaltTheAxis) {
  Bench bench(testConfig(warned()));
  ASSERT_TRUE(bench.boot());
  bench.drive.error = 0x5001;
  bench.drive.warning = true;
  bench.run(milliseconds(100));
  ASSERT_TRUE(bench.enable());
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
}

TEST(Axis, BitSevenIsNoWarningWhereTheFamilyHasNone) {
  DriveProfile profile = testProfile();
  profile.warning_stops = true;
  profile.has_warning_bit = false;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.warning = true;
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.axis.state().statusword & 0x0080, 0x0080);
  EXPECT_FALSE(bench.axis.state().warning);
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
}

TEST(AxisWarnings, AreToldOnceAndAreToldFromWhatStopsTheAxis) {
  DriveProfile profile = testProfile();
  profile.before_enable = {test::from("profile_velocity", "limits.velocity")};
  Bench bench(testConfig(profile));
  bench.drive.aborts[{0x6081, 0}] = 0x06020000;
  ASSERT_TRUE(bench.boot());
  EXPECT_EQ(bench.axis.notice(bench.axis.noticeCount()).kind, NoticeKind::error);
  ASSERT_TRUE(bench.enable());
  EXPECT_EQ(bench.axis.noticeCount(), 1u);
  EXPECT_EQ(bench.axis.notice(bench.axis.noticeCount()).kind, NoticeKind::warning);
  EXPECT_THAT(bench.axis.notice(), HasSubstr("profile_velocity"));
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  ASSERT_TRUE(bench.enable());
  EXPECT_EQ(bench.axis.noticeCount(), 1u);
  bench.fail(0x8611);
  bench.run(milliseconds(20));
  EXPECT_EQ(bench.axis.noticeCount(), 2u);
  EXPECT_EQ(bench.axis.notice(bench.axis.noticeCount()).kind, NoticeKind::error);
}

}  // namespace
}  // namespace cia402::drive
