// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Goals that a drive goes to by itself, ended under way: what it is told, and what where it does
// not do that.
#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;

AxisConfig profilePosition(DriveProfile profile) {
  AxisConfig config = testConfig(std::move(profile));
  config.mode = "profile_position";
  return config;
}

/// On its way to 3.1 rad, at 2 rad/s.
struct GoingAxis : Bench {
  explicit GoingAxis(DriveProfile profile = testProfile())
      : Bench(profilePosition(std::move(profile))) {
    EXPECT_TRUE(boot() && enable());
    EXPECT_TRUE(give(3.1));
    EXPECT_TRUE(runUntil([&] { return axis.state().position > 1.6; }));
    drive.controlwords.clear();
    drive.accepted.clear();
  }
  bool ended() {
    return runUntil([&] { return !axis.endsGoal(); });
  }
};

// Bit 8, which stays until the drive has the place where it stands, handed over twice: by then it
// has taken that and not its goal once more, whatever was lost.
TEST(EndedGoal, IsReplacedWhileTheHaltBitHoldsTheDrive) {
  GoingAxis axis;
  axis.axis.stopSetPoint();
  ASSERT_TRUE(axis.axis.endsGoal());
  ASSERT_TRUE(axis.ended());
  axis.run(milliseconds(40));
  EXPECT_EQ(axis.drive.controlwords,
            (std::vector<std::uint16_t>{0x012F, 0x013F, 0x012F, 0x013F, 0x012F, 0x002F}));
  const auto stands = static_cast<std::int32_t>(axis.drive.position);
  EXPECT_EQ(axis.drive.accepted, (std::vector<std::int32_t>{stands, stands}));
  EXPECT_LT(stands, 20000);
  EXPECT_FALSE(axis.axis.state().halted);
  ASSERT_TRUE(axis.give(1.0));
  axis.run(milliseconds(1000));
  EXPECT_EQ(axis.drive.position, 10000);
}

TEST(EndedGoal, ThatTheDriveDoesNotLetGoIsEndedByAQuickStop) {
  GoingAxis axis;
  axis.drive.acknowledges = false;
  axis.axis.stopSetPoint();
  ASSERT_TRUE(axis.runUntil([&] { return axis.drive.state == FakeDrive::S::disabled; }));
  EXPECT_THAT(axis.axis.notice(), HasSubstr("did not take the place where it stands"));
  EXPECT_LT(axis.drive.position, 20000);
  axis.cycle();
  EXPECT_FALSE(axis.axis.endsGoal());
}

TEST(EndedGoal, OfAMotorThatDoesNotComeToRestIsEndedByAQuickStop) {
  GoingAxis axis;
  axis.drive.coast = 500;
  axis.axis.stopSetPoint();
  axis.run(milliseconds(1900));
  EXPECT_TRUE(axis.axis.endsGoal());
  axis.run(milliseconds(200));  // Timing::state_change: 2 s
  EXPECT_THAT(axis.axis.notice(), HasSubstr("did not come to rest in front of the goal"));
  EXPECT_EQ(axis.drive.state, FakeDrive::S::quick);
}

TEST(EndedGoal, OfAMotorThatIsHeldInFrontOfItsStopPointIsWhereItStands) {
  DriveProfile profile = testProfile();
  profile.halt_supported = false;
  GoingAxis axis(std::move(profile));
  axis.axis.stopSetPoint();
  axis.run(milliseconds(60));
  ASSERT_EQ(axis.drive.accepted.size(), 2u);
  axis.drive.at_limit = true;
  const auto stands = static_cast<std::int32_t>(axis.drive.position);
  ASSERT_GT(axis.drive.accepted_target, stands + 100);
  ASSERT_TRUE(axis.ended());
  EXPECT_EQ(axis.drive.accepted_target, stands);
  axis.drive.at_limit = false;
  axis.run(milliseconds(500));
  EXPECT_EQ(axis.drive.position, stands);
}

TEST(EndedGoal, ThereIsNoneOfAnAxisThatStands) {
  Bench bench(profilePosition(testProfile()));
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.run(milliseconds(200));
  bench.drive.controlwords.clear();
  bench.axis.stopSetPoint();
  EXPECT_FALSE(bench.axis.endsGoal());
  bench.run(milliseconds(200));
  EXPECT_TRUE(bench.drive.controlwords.empty());
}

TEST(EndedGoal, IsGivenUpBeforeTheModeIsSwitched) {
  GoingAxis axis;
  axis.drive.acknowledge_delay = 25;
  axis.axis.stopSetPoint();
  ASSERT_TRUE(axis.runUntil([&] { return !axis.drive.accepted.empty(); }));
  ASSERT_TRUE(axis.axis.endsGoal());
  const double stands = axis.drive.position;
  ASSERT_TRUE(axis.perform(ProcedureKind::set_mode, "cyclic_position").success);
  EXPECT_EQ(axis.drive.accepted.size(), 2u) << "the place where it stands is handed over twice";
  EXPECT_EQ(axis.drive.position, stands);
}

}  // namespace
}  // namespace cia402::drive
