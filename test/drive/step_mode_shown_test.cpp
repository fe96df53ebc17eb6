// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives that take a mode in operation enabled only.
#include "drive/procedure_steps.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::stepsOf;
using test::testConfig;
using test::testProfile;
using S = FakeDrive::S;
using Again = ModeChange::Again;
using namespace std::chrono_literals;

DriveProfile forgetful(Again again) {
  DriveProfile profile = testProfile();
  profile.mode_change.shown_when_enabled = true;
  profile.mode_change.again = again;
  return profile;
}

/// 6060h goes by SDO: another object has its place in RPDO1.
test::Layout modeBySdo() {
  test::Layout layout = test::testLayout();
  layout.outputs[0].objects[1] = {{0x2000, 0}, 8};
  return layout;
}

struct ForgetfulBench : Bench {
  explicit ForgetfulBench(DriveProfile profile, test::Layout node = test::testLayout())
      : Bench(testConfig(std::move(profile)), std::move(node)) {
    drive.forgets_mode = true;
    EXPECT_TRUE(boot());
    each_cycle = [this] {
      if (modes.empty() || modes.back() != drive.commanded_mode) {
        modes.push_back(drive.commanded_mode);
      }
      if (drive.commanded_mode == 0) ++zeros;
      if (drive.mode != wanted && axis.state().ready_for_motion) ready_elsewhere = true;
    };
  }
  std::vector<int> modes;  ///< as they were commanded
  int wanted = 8;
  int zeros = 0;                 ///< cycles in which mode 0 was commanded
  bool ready_elsewhere = false;  ///< took commands while the drive was in another mode
};

const char kWaitsForMode[] = "waiting for the mode | 6061:00 to show 8 (cyclic_position)";

TEST(ModeShownStep, GoesThroughModeZeroWhereOnlyAChangeCounts) {
  ForgetfulBench world(forgetful(Again::through_zero));
  world.drive.mode = 1;
  const std::vector<std::string> steps = stepsOf(world, ProcedureKind::enable);
  EXPECT_TRUE(world.axis.procedure().success) << world.axis.procedure().message;
  EXPECT_EQ(world.modes, (std::vector<int>{8, 0, 8}));
  EXPECT_GE(world.zeros, 2) << "a frame may get lost";
  EXPECT_EQ(world.drive.mode, 8);
  EXPECT_FALSE(world.ready_elsewhere);
  EXPECT_THAT(steps, testing::Contains(kWaitsForMode));
  EXPECT_TRUE(world.axis.state().ready_for_motion);
}

TEST(ModeShownStep, CommandsTheModeOnceMoreBySdo) {
  for (const Again again : {Again::same, Again::through_zero}) {
    SCOPED_TRACE(static_cast<int>(again));
    ForgetfulBench world(forgetful(again), modeBySdo());
    world.drive.mode = 1;
    world.drive.writes.clear();
    EXPECT_THAT(stepsOf(world, ProcedureKind::enable), testing::Contains(kWaitsForMode));
    EXPECT_TRUE(world.axis.procedure().success) << world.axis.procedure().message;
    EXPECT_EQ(world.drive.mode, 8);
    using Writes = std::vector<std::pair<unsigned, std::uint64_t>>;
    EXPECT_EQ(world.drive.writes, again == Again::same
                                      ? (Writes{{0x6060, 8}, {0x6060, 8}})
                                      : (Writes{{0x6060, 8}, {0x6060, 0}, {0x6060, 8}}));
  }
}

TEST(ModeShownStep, CommandsNothingMoreWhereTheModeIsShown) {
  ForgetfulBench world(forgetful(Again::through_zero));
  world.drive.mode = 8;
  EXPECT_THAT(stepsOf(world, ProcedureKind::enable),
              testing::Not(testing::Contains(kWaitsForMode)));
  EXPECT_EQ(world.modes, (std::vector<int>{8}));
}

TEST(ModeShownStep, WaitsForADriveThatNeedsNoSecondCommand) {
  ForgetfulBench world(forgetful(Again::never));
  world.drive.forgets_mode = false;
  world.drive.mode = 1;
  world.drive.mode_delay = 100000;
  const auto look = world.each_cycle;
  Time enabled{};
  world.each_cycle = [&] {
    look();
    if (enabled == Time{} && world.drive.state == S::enabled) enabled = world.now;
    if (enabled != Time{} && world.now - enabled > 500ms) world.drive.mode_delay = 0;
  };
  const ProcedureStatus& status = world.perform(ProcedureKind::enable);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_GT(world.now - enabled, 500ms);
  EXPECT_FALSE(world.ready_elsewhere);
  EXPECT_EQ(world.modes, (std::vector<int>{8}));
}

TEST(ModeShownStep, AModeThatIsNotTakenSwitchesTheAxisOff) {
  for (const Again again : {Again::never, Again::same, Again::through_zero}) {
    SCOPED_TRACE(static_cast<int>(again));
    ForgetfulBench world(forgetful(again));
    world.drive.forgets_mode = false;
    world.drive.mode = 1;
    world.drive.mode_delay = 100000;
    Time enabled{};
    const auto look = world.each_cycle;
    world.each_cycle = [&] {
      look();
      if (enabled == Time{} && world.drive.state == S::enabled) enabled = world.now;
    };
    const ProcedureStatus& status = world.perform(ProcedureKind::enable);
    EXPECT_FALSE(status.success);
    EXPECT_GE(world.now - enabled, 1s) << "timing/mode_change";
    EXPECT_THAT(status.message,
                HasSubstr("shoulder (node 3): the drive is in operation, but not in mode "
                          "cyclic_position: 6061:00 shows -1 instead of 8 1"));
    EXPECT_THAT(status.message, HasSubstr("it is disabled"));
    EXPECT_FALSE(world.ready_elsewhere);
    world.run(40ms);
    EXPECT_EQ(world.drive.state, S::disabled);
    EXPECT_EQ(world.drive.commanded_mode, 8) << "what it is to be enabled in next";
  }
}

TEST(ModeShownStep, GoesByTheModeBetweenWhereTheDriveDoesNotStandTheChange) {
  DriveProfile profile = forgetful(Again::same);
  profile.mode_change.detours = {{"cyclic_position", "cyclic_velocity", "profile_velocity"}};
  ForgetfulBench world(profile, modeBySdo());
  world.drive.mode = 8;
  ASSERT_TRUE(world.perform(ProcedureKind::set_mode, "csv").success);
  EXPECT_EQ(world.drive.mode, 8) << "forgotten, for it is disabled";
  world.drive.writes.clear();
  world.wanted = 9;
  const ProcedureStatus& status = world.perform(ProcedureKind::enable);
  EXPECT_TRUE(status.success) << status.message;
  using Write = std::pair<unsigned, std::uint64_t>;
  EXPECT_EQ(world.drive.writes, (std::vector<Write>{{0x6060, 9}, {0x6060, 3}, {0x6060, 9}}));
  EXPECT_EQ(world.drive.mode, 9);
  EXPECT_EQ(world.axis.state().mode->name, "cyclic_velocity");
  EXPECT_FALSE(world.ready_elsewhere);
}

}  // namespace
}  // namespace cia402::drive
