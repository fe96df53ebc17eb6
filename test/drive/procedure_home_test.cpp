// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;

AxisConfig homingConfig(DriveProfile profile = testProfile(), int method = 17) {
  AxisConfig config = testConfig(std::move(profile));
  config.homing = HomingOptions();
  config.homing->method = method;
  config.homing->search_velocity = 0.3;
  config.homing->offset = -3.05;
  config.homing->timeout = std::chrono::seconds(3);
  return config;
}

TEST(HomeProcedure, WritesParametersSearchesAndComesBackToItsMode) {
  Bench bench(homingConfig());
  ASSERT_TRUE(bench.boot());
  bench.drive.writes.clear();
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_TRUE(status.success) << status.message;
  using Write = std::pair<unsigned, std::uint64_t>;
  EXPECT_EQ(bench.drive.writes,
            (std::vector<Write>{{0x6098, 17}, {0x6099, 3000}, {0x607C, 0xFFFF88DC}}));  // -30500
  EXPECT_EQ(bench.drive.homings, 1);
  EXPECT_TRUE(bench.axis.state().homed);
  EXPECT_NEAR(bench.axis.state().position, -3.05, 1e-9);
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_position");
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
  EXPECT_THAT(status.message,
              HasSubstr("shoulder: homed by method 17 (negative limit switch) in "));
  EXPECT_THAT(status.message, HasSubstr(", position -3.050 rad"));
}

TEST(HomeProcedure, NothingJumpsWhenTheModeComesBack) {
  Bench bench(homingConfig());
  ASSERT_TRUE(bench.boot());
  double before = bench.drive.position;
  double largest = 0;
  bench.each_cycle = [&] {
    if (bench.drive.mode == 8) largest = std::max(largest, std::abs(bench.drive.position - before));
    before = bench.drive.position;
  };
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  bench.run(milliseconds(100));
  EXPECT_EQ(largest, 0.0);
  EXPECT_EQ(bench.drive.target_position, -30500);
}

TEST(HomeProcedure, TellsItsStepsWhileItRuns) {
  Bench bench(homingConfig());
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::home, {}, 0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.axis.procedure().step == "searching home"; }));
  EXPECT_EQ(bench.axis.procedure().waiting_for,
            "homing attained (statusword bit 12), method 17 (negative limit switch)");
}

TEST(HomeProcedure, AnOldAttainedBitIsNoSuccess) {
  Bench bench(homingConfig());
  bench.drive.keeps_attained = true;
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  bench.drive.homing_cycles = 250;
  bench.drive.position = 7000;
  const Time started = bench.now;
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  EXPECT_EQ(bench.drive.homings, 2);
  EXPECT_GT(bench.now - started, std::chrono::seconds(1));
}

TEST(HomeProcedure, AnOldResultThatStaysIsNotBelievedEither) {
  Bench bench(homingConfig());
  bench.drive.keeps_attained = true;
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  // The drive ignores the edge: statusword 0x1637 in the homing mode from now on.
  bench.each_cycle = [&] {
    if (bench.drive.mode == 6) bench.drive.silent = true;
    if (bench.drive.silent) {
      bench.bring({{{0x6041, 0}, 0x1637},
                   {{0x6064, 0}, static_cast<std::uint32_t>(-30500)},
                   {{0x6061, 0}, 6}});
    }
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("never dropped the result of an earlier homing"));
}

TEST(HomeProcedure, MethodsThatDoNotMoveSucceedTwice) {
  DriveProfile profile = testProfile();
  Bench bench(homingConfig(profile, 37));
  bench.drive.keeps_attained = true;
  bench.drive.homing_cycles = 0;
  bench.drive.homing_moves = false;
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  EXPECT_EQ(bench.drive.homings, 2);
}

TEST(HomeProcedure, ATimeOutQuickStopsAndSaysWhatWasAwaited) {
  Bench bench(homingConfig());
  bench.drive.never_homes = true;
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("shoulder (node 3): homing timed out after 3 s waiting for "
                                        "homing attained (statusword bit 12)"));
  EXPECT_THAT(status.message, HasSubstr("quick stop is commanded"));
  EXPECT_THAT(status.message, HasSubstr("still searching"));
  bench.run(milliseconds(100));
  EXPECT_NE(bench.drive.state, FakeDrive::S::enabled);
  EXPECT_EQ(bench.drive.velocity, 0);
  EXPECT_FALSE(bench.axis.state().homed);
  bench.drive.never_homes = false;
  EXPECT_TRUE(bench.enable());
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_position");
}

TEST(HomeProcedure, AHomingErrorOfTheDriveEndsStandingInTheOldMode) {
  Bench bench(homingConfig());
  bench.drive.homing_fails = true;
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(
      status.message,
      HasSubstr("shoulder (node 3): homing stopped: the drive reports homing error, stopped"));
  EXPECT_THAT(status.message, HasSubstr("and is not homed"));
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_position");
  EXPECT_EQ(bench.drive.controlword, 0x000F);
}

TEST(HomeProcedure, CancellingStopsTheSearch) {
  Bench bench(homingConfig());
  bench.drive.never_homes = true;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::home, {}, 0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.velocity < 0; }));
  bench.axis.cancel("the action was cancelled", bench.now);
  bench.run(milliseconds(12));
  EXPECT_EQ(bench.drive.velocity, 0);
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_FALSE(bench.axis.procedure().success);
  EXPECT_THAT(
      bench.axis.procedure().message,
      HasSubstr("homing stopped: it was cancelled: the action was cancelled; the axis stands "
                "at 1."));
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_position");
  EXPECT_EQ(bench.drive.controlword, 0x000F);
}

TEST(HomeProcedure, AFaultDuringTheSearchFailsItInWords) {
  Bench bench(homingConfig());
  bench.drive.never_homes = true;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::home, {}, 0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.velocity < 0; }));
  bench.fail(0x8611);
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("home failed: shoulder (node 3): the drive left operation enabled"));
  EXPECT_THAT(bench.axis.procedure().message, HasSubstr("0x8611 following error"));
}

TEST(HomeProcedure, AHaltPreemptsItAndEnableGoesOnInTheWorkingMode) {
  Bench bench(homingConfig());
  bench.drive.never_homes = true;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::home, {}, 0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.velocity < 0; }));
  EXPECT_TRUE(bench.perform(ProcedureKind::halt).success);
  EXPECT_EQ(bench.drive.velocity, 0);
  EXPECT_TRUE(bench.perform(ProcedureKind::enable).success);
  bench.run(milliseconds(20));
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_position");
  EXPECT_EQ(bench.drive.controlword, 0x000F);
}

TEST(HomeProcedure, ShiftsInSoftwareWhatAnUnwrittenHomeOffsetMisses) {
  DriveProfile profile = testProfile();
  profile.homing.writes.pop_back();
  Bench bench(homingConfig(profile));
  bench.drive.dictionary[{0x607C, 0}] = {500, 4};  // 0.05 rad, set by somebody's tool
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  EXPECT_EQ(bench.drive.position, 500);
  EXPECT_NEAR(bench.axis.state().position, -3.05, 1e-9);
  bench.follow(-3.0);
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.drive.target_position, 1000);
}

TEST(HomeProcedure, DeclaresZeroWhereTheDriveHasNoHoming) {
  DriveProfile profile = testProfile();
  profile.homing.methods = {{std::nullopt, {"declared", false, {}}}};
  AxisConfig config = homingConfig(profile);
  config.homing->method.reset();
  config.homing->offset = 0.25;
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  bench.drive.writes.clear();
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_EQ(status.message,
            "shoulder: homed by declaring the present position to be 0.250 rad; nothing moved");
  EXPECT_TRUE(bench.axis.state().homed);
  bench.cycle();
  EXPECT_NEAR(bench.axis.state().position, 0.25, 1e-9);
  EXPECT_TRUE(bench.drive.writes.empty());
}

TEST(HomeProcedure, RefusalsSayWhatIsMissing) {
  Bench none;
  ASSERT_TRUE(none.boot());
  EXPECT_THAT(none.refusal(ProcedureKind::home),
              HasSubstr("shoulder (node 3): cannot home: no homing is configured"));

  AxisConfig no_method = homingConfig();
  no_method.homing->method.reset();
  Bench without(no_method);
  ASSERT_TRUE(without.boot());
  EXPECT_THAT(without.refusal(ProcedureKind::home), HasSubstr("no homing method is configured"));

  DriveProfile profile = testProfile();
  profile.homing.methods.clear();
  Bench unable(homingConfig(profile));
  ASSERT_TRUE(unable.boot());
  EXPECT_THAT(unable.refusal(ProcedureKind::home), HasSubstr("set_position"));
}

TEST(SetPositionProcedure, DeclaresThePresentPositionAndKeepsTheDriveWhereItIs) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  const ProcedureStatus& status = bench.perform(ProcedureKind::set_position, {}, -0.5);
  EXPECT_THAT(status.message, HasSubstr("shoulder: the present position is declared to be -0.500 "
                                        "rad (it read 1.23"));
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.drive.position, 12345);
  EXPECT_NEAR(bench.axis.state().position, -0.5, 1e-9);
  EXPECT_NEAR(bench.axis.target(), -0.5, 1e-9);
  bench.follow(-0.4);
  bench.run(milliseconds(60));
  EXPECT_EQ(bench.drive.target_position, 13345);
}

TEST(SetPositionProcedure, IsRefusedInMotionAndForNonsense) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.coast = 5000;
  bench.run(milliseconds(200));
  const ProcedureStatus& status = bench.perform(ProcedureKind::set_position, {}, 0.0);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message,
              HasSubstr("shoulder (node 3): declaring the position needs standstill "
                        "(velocity 0.500)"));
  EXPECT_THAT(bench.refusal(ProcedureKind::set_position, {}, kUnknown), HasSubstr("finite number"));
}

}  // namespace
}  // namespace cia402::drive
