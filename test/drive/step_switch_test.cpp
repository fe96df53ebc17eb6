// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What an enabled axis waits for, and goes through, on its way into another mode.
#include <limits>

#include "drive/axis/standstill.h"
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
using testing::Not;
using S = FakeDrive::S;
using namespace std::chrono_literals;

constexpr std::pair<unsigned, unsigned> kUpperLimit{0x607D, 2};

/// Limits of +-3.1 rad in the drive, 0.0001 rad a count.
AxisConfig withDriveLimits(const std::string& mode) {
  DriveProfile profile = testProfile();
  profile.objects.push_back(test::object("lower", 0x607D, DataType::int32, Quantity::position, 1));
  profile.objects.push_back(test::object("upper", 0x607D, DataType::int32, Quantity::position, 2));
  profile.startup = {test::from("lower", "limits.lower"), test::from("upper", "limits.upper")};
  for (NamedWrite& write : profile.startup) write.when_homed = write.optional = true;
  AxisConfig config = testConfig(std::move(profile));
  config.mode = mode;
  return config;
}

/// It was carried beyond its upper limit while nothing holds its position.
struct BeyondItsLimit : Bench {
  BeyondItsLimit() : Bench(withDriveLimits("cyclic_velocity")) {
    drive.dictionary[{0x607D, 1}] = drive.dictionary[kUpperLimit] = {0, 4};
    EXPECT_TRUE(boot());
    EXPECT_TRUE(enable());
    run(100ms);
    drive.position = 32000;
    run(300ms);
    EXPECT_EQ(drive.dictionary[kUpperLimit].first, 31000u);
  }
};

TEST(ReadyToSwitchStep, OpensTheLimitBeyondWhichItStandsBeforeThePositionIsHeld) {
  BeyondItsLimit bench;
  bool open_first = true;
  constexpr std::uint32_t kOpen = std::numeric_limits<std::int32_t>::max();
  bench.each_cycle = [&] {
    const bool open = bench.drive.dictionary[kUpperLimit].first == kOpen;
    open_first &= open || bench.drive.commanded_mode != 8;
  };
  EXPECT_THAT(stepsOf(bench, ProcedureKind::set_mode, "csp"),
              testing::Contains("writing position limits | the drive to take the joint's limits"));
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
  EXPECT_TRUE(open_first);
  EXPECT_EQ(bench.drive.position, 32000);
}

TEST(ReadyToSwitchStep, DoesNotSwitchWhereTheDriveKeepsTheLimit) {
  BeyondItsLimit bench;
  bench.drive.aborts[kUpperLimit] = 0x08000022;
  const ProcedureStatus& status = bench.perform(ProcedureKind::set_mode, "csp");
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("the mode is not switched, as the axis is beyond the "
                                        "position limits that the drive keeps"));
  EXPECT_THAT(status.message, HasSubstr("0x08000022"));
  bench.run(100ms);
  EXPECT_EQ(bench.drive.commanded_mode, 9);
  EXPECT_EQ(bench.drive.state, S::enabled);
}

TEST(ReadyToSwitchStep, WaitsUntilItIsSeenToStandAfterALastSetPoint) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(200ms);
  ASSERT_TRUE(bench.give(1.2346)) << "one count further";
  bench.run(8ms);
  const Time began = bench.now;
  const ProcedureStatus& status = bench.perform(ProcedureKind::set_mode, "csv");
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_GE(bench.now - began, Standstill::kWindow - 12ms);
  EXPECT_THAT(status.message, HasSubstr("shoulder: mode cyclic_velocity after 0.0"));
}

TEST(ReadyToSwitchStep, ATargetThatWasNotReachedIsTakenBackAndTheDriveComesBackFromIt) {
  AxisConfig config = testConfig();
  config.mode = "profile_position";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.axis.setTarget(3.0));
  bench.run(100ms);
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  ASSERT_EQ(bench.drive.accepted, (std::vector<std::int32_t>{30000}));
  const Time began = bench.now;
  Time switched{};
  bench.each_cycle = [&] {
    if (bench.drive.commanded_mode == 9 && switched == Time{}) switched = bench.now;
  };
  EXPECT_THAT(stepsOf(bench, ProcedureKind::set_mode, "csv"),
              testing::Contains("taking back a target that was not reached | the drive to be done "
                                "with it"));
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
  ASSERT_GE(bench.drive.accepted.size(), 2u);
  EXPECT_NEAR(bench.drive.accepted.back(), bench.drive.position, 1.0);
  EXPECT_GE(switched - began, 700ms) << "some 1.5 rad, back from which it goes 2 rad/s at most";
}

TEST(SwitchStep, ADriveThatStandsTheChangeStaysEnabled) {
  DriveProfile profile = testProfile();
  profile.mode_change.detours = {{"cyclic_velocity", "cyclic_position", ""}};
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bool disabled = false;
  bench.each_cycle = [&] { disabled |= bench.drive.state != S::enabled; };
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csv").success);
  EXPECT_FALSE(disabled) << "the detour is of the other direction";
  const ProcedureStatus& status = bench.perform(ProcedureKind::set_mode, "csp");
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_TRUE(disabled);
  EXPECT_THAT(status.message, HasSubstr("disabled meanwhile as the drive demands"));
}

TEST(SwitchStep, GoesThroughTheModeBetween) {
  DriveProfile profile = testProfile();
  profile.mode_change.detours = {{"cyclic_position", "cyclic_velocity", "profile_velocity"}};
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  std::vector<int> modes;
  bool disabled = false;
  bench.each_cycle = [&] {
    disabled |= bench.drive.state != S::enabled;
    if (modes.empty() || modes.back() != bench.drive.mode) modes.push_back(bench.drive.mode);
  };
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csv").success);
  bench.run(20ms);
  EXPECT_EQ(modes, (std::vector<int>{8, 3, 9}));
  EXPECT_FALSE(disabled);
}

TEST(SwitchStep, IsNotSwitchedWhereTheDriveCannotBeDisabledForIt) {
  DriveProfile profile = testProfile();
  profile.mode_change.needs_disabling = true;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(100ms);
  bench.drive.stuck.insert(S::enabled);
  const Time began = bench.now;
  EXPECT_THAT(stepsOf(bench, ProcedureKind::set_mode, "csv"),
              testing::Contains("disabling, as the drive does not take that mode while enabled | "
                                "the drive to show switch on disabled"));
  EXPECT_FALSE(bench.axis.procedure().success);
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("mode cyclic_velocity was not taken: the drive must be disabled for it and "
                        "was not within 2"));
  EXPECT_GE(bench.now - began, 2s);
  EXPECT_EQ(bench.drive.commanded_mode, 8);
}

TEST(ModeStep, ADriveThatDoesNotFollowGetsTheModeBackThatItWasIn) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.mode_delay = 100000;
  std::vector<int> modes;
  bench.each_cycle = [&] {
    const int mode = bench.drive.commanded_mode;
    if (modes.empty() || modes.back() != mode) modes.push_back(mode);
  };
  EXPECT_FALSE(bench.perform(ProcedureKind::set_mode, "csv").success);
  bench.run(40ms);
  EXPECT_EQ(modes, (std::vector<int>{8, 9, 8}));
  EXPECT_EQ(bench.axis.modeName(), "cyclic_position");
}

TEST(ModeStep, CutOffInTheModeBetweenTheAxisIsEnabledInTheOneThatItWasBoundFor) {
  DriveProfile profile = testProfile();
  profile.mode_change.shown_when_enabled = true;
  profile.mode_change.again = ModeChange::Again::same;
  profile.mode_change.detours = {{"profile_velocity", "cyclic_position", "cyclic_velocity"}};
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.forgets_mode = true;
  bench.drive.mode = 3;
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.mode == 9; })) << "half way";
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  bench.drive.forgets_mode = false;
  EXPECT_TRUE(bench.enable());
  EXPECT_EQ(bench.axis.modeName(), "cyclic_position");
}

}  // namespace
}  // namespace cia402::drive
