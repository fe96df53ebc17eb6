// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// disable, quick_stop and halt.
#include <cmath>

#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;

AxisConfig inMode(const std::string& mode) {
  AxisConfig config = testConfig();
  config.mode = mode;
  return config;
}

TEST(DisableProcedure, GoesDownByDisableOperationAndDisableVoltage) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(milliseconds(100));
  bench.drive.controlwords.clear();
  const ProcedureStatus& status = bench.perform(ProcedureKind::disable);
  EXPECT_TRUE(status.success);
  EXPECT_EQ(status.message, "shoulder: disabled");
  EXPECT_EQ(bench.drive.controlwords, (std::vector<std::uint16_t>{0x0007, 0x0000}));
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
}

TEST(DisableProcedure, AMovingAxisIsStoppedByTheQuickStopRampFirst) {
  Bench bench(inMode("cyclic_velocity"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.follow(1.0);
  bench.run(milliseconds(200));
  EXPECT_NEAR(bench.drive.velocity, 10000, 1);
  bench.drive.quick_stop_deceleration = 100000;  // 0.1 s
  bench.drive.controlwords.clear();
  EXPECT_TRUE(bench.perform(ProcedureKind::disable).success);
  ASSERT_GE(bench.drive.controlwords.size(), 1u);
  EXPECT_EQ(bench.drive.controlwords[0], 0x0002);
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
}

TEST(DisableProcedure, TimesOutWithWhatTheDriveShows) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(milliseconds(100));
  bench.drive.stuck.insert(FakeDrive::S::enabled);
  const ProcedureStatus& status = bench.perform(ProcedureKind::disable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("shoulder (node 3): disabling timed out after 4"));
  EXPECT_THAT(status.message, HasSubstr("0x0007, disable operation (transition 5)"));
}

TEST(QuickStopProcedure, StopsAndEndsDisabled) {
  Bench bench(inMode("cyclic_velocity"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.follow(-1.0);
  bench.run(milliseconds(200));
  bench.drive.quick_stop_deceleration = 100000;
  const ProcedureStatus& status = bench.perform(ProcedureKind::quick_stop);
  EXPECT_TRUE(status.success);
  EXPECT_EQ(status.message, "shoulder: stopped and disabled; enable to go on");
  EXPECT_EQ(bench.drive.velocity, 0);
  EXPECT_FALSE(bench.axis.state().ready_for_motion);
}

TEST(QuickStopProcedure, AnAxisThatDoesNotComeToRestIsReported) {
  Bench bench(inMode("cyclic_velocity"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.coast = 3000;  // hanging load, dead brake
  const ProcedureStatus& status = bench.perform(ProcedureKind::quick_stop);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message,
              HasSubstr("shoulder (node 3): the quick stop did not end at standstill within 2"));
  EXPECT_EQ(bench.drive.controlword, 0x0002);
}

TEST(QuickStopProcedure, ADriveThatStaysWithoutHoldingIsSwitchedOff) {
  Bench bench;
  bench.drive.quick_stop_ends = false;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  const ProcedureStatus& status = bench.perform(ProcedureKind::quick_stop);
  EXPECT_TRUE(status.success);
  EXPECT_THAT(status.message, HasSubstr("disable voltage is commanded"));
  bench.run(milliseconds(20));
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
}

TEST(HaltProcedure, RampsCyclicPositionTargetsDownByTheAccelerationLimit) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  double target = bench.axis.target();
  bench.each_cycle = [&] {  // 1 rad/s
    if (bench.axis.setTarget(target + 0.004)) target += 0.004;
  };
  bench.run(milliseconds(200));
  const double before = bench.axis.target();
  const ProcedureStatus& status = bench.perform(ProcedureKind::halt);
  EXPECT_TRUE(status.success) << status.message;
  // v^2 / 2a = 1 / 16 rad, and at most one cycle's way before the ramp begins.
  EXPECT_NEAR(bench.axis.target() - before, 0.0625, 0.0045);
  EXPECT_EQ(bench.drive.controlword, 0x000F);
  EXPECT_THAT(status.message, HasSubstr("shoulder: halted at 1."));
  EXPECT_THAT(bench.axis.motionRefusal(), HasSubstr("halted; enable releases the halt"));
}

/// The newest set-point was handed over once, and once more: the drive has it, whatever was lost.
bool toldTwice(const test::FakeDrive& drive) {
  const auto& accepted = drive.accepted;
  return accepted.size() >= 2 && accepted.back() == accepted[accepted.size() - 2];
}

TEST(HaltProcedure, UsesTheHaltBitWhereTheDrivePlans) {
  Bench bench(inMode("profile_position"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.axis.setTarget(3.0));
  bench.run(milliseconds(200));
  EXPECT_TRUE(bench.perform(ProcedureKind::halt).success);
  EXPECT_EQ(bench.drive.controlword & 0x0100, 0x0100);
  EXPECT_EQ(bench.drive.velocity, 0);
  const double halted_at = bench.drive.position;
  EXPECT_FALSE(bench.axis.setTarget(2.0));
  // Released, the drive does not go on to where it was going.
  EXPECT_TRUE(bench.perform(ProcedureKind::enable).success);
  bench.run(milliseconds(500));
  EXPECT_EQ(bench.drive.controlword & 0x0100, 0);
  EXPECT_NEAR(bench.drive.position, halted_at, 1.0);
  EXPECT_TRUE(toldTwice(bench.drive));
  EXPECT_TRUE(bench.axis.setTarget(2.0));
}

TEST(HaltProcedure, GivesThePointWhereTheAxisCanStopWhereThereIsNoHaltBit) {
  DriveProfile profile = testProfile();
  profile.halt_supported = false;
  AxisConfig config = testConfig(profile);
  config.mode = "profile_position";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.axis.setTarget(3.0));  // the drive goes there at 2 rad/s
  bench.run(milliseconds(200));
  const double from = bench.axis.state().position;
  EXPECT_TRUE(bench.perform(ProcedureKind::halt).success);
  // v^2 / 2a, and what the axis may go on until the drive has the point: up to six cycles.
  EXPECT_GE(bench.axis.state().position - from, 2.0 * 2.0 / (2 * 8.0));
  EXPECT_LE(bench.axis.state().position - from, 2.0 * 2.0 / (2 * 8.0) + 6 * 0.004 * 2.0);
  EXPECT_EQ(bench.drive.controlword & 0x0100, 0);
  EXPECT_TRUE(toldTwice(bench.drive));
}

// The goal is ahead, but nearer than the motor can stop: left at that, it would turn back.
TEST(HaltProcedure, GivesThePointWhereTheAxisCanStopWhereItsGoalCameTooNear) {
  DriveProfile profile = testProfile();
  profile.halt_supported = false;
  AxisConfig config = testConfig(profile);
  config.mode = "profile_position";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.axis.setTarget(3.0));
  bench.run(milliseconds(200));
  const double from = bench.axis.state().position;
  ASSERT_TRUE(bench.axis.setTarget(from + 0.15));  // it needs 0.25
  bench.run(milliseconds(20));
  EXPECT_TRUE(bench.perform(ProcedureKind::halt).success);
  EXPECT_GE(bench.axis.state().position - from, 2.0 * 2.0 / (2 * 8.0));
}

TEST(HaltProcedure, NeverGoesBeyondAGoalAtWhichItCanStop) {
  DriveProfile profile = testProfile();
  profile.halt_supported = false;
  AxisConfig config = testConfig(profile);
  config.mode = "profile_position";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.axis.setTarget(3.0));
  bench.run(milliseconds(200));
  const double goal = bench.axis.state().position + 0.28;  // it needs 0.25
  ASSERT_TRUE(bench.axis.setTarget(goal));
  bench.run(milliseconds(8));
  EXPECT_TRUE(bench.perform(ProcedureKind::halt).success);
  EXPECT_LE(bench.axis.state().position, goal + 1e-3);
}

TEST(HaltProcedure, AGoalThatALimitKeepsItFromIsCalledBackTwice) {
  Bench bench(inMode("profile_position"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.axis.setTarget(3.0));
  bench.run(milliseconds(200));
  EXPECT_FALSE(toldTwice(bench.drive)) << "a motion is told once";
  bench.drive.at_limit = true;
  bench.run(milliseconds(1000));
  EXPECT_NEAR(bench.drive.accepted_target, bench.drive.position, 1.0);
  EXPECT_TRUE(toldTwice(bench.drive));
}

TEST(HaltProcedure, RampsVelocitySetPointsDownInCyclicVelocity) {
  DriveProfile profile = testProfile();
  AxisConfig config = testConfig(profile);
  config.mode = "cyclic_velocity";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.follow(1.0);
  bench.run(milliseconds(200));
  EXPECT_TRUE(bench.perform(ProcedureKind::halt).success);
  EXPECT_EQ(bench.drive.target_velocity, 0);
  EXPECT_EQ(bench.drive.controlword & 0x0100, 0);
}

TEST(HaltProcedure, AnAxisThatGoesOnIsQuickStopped) {
  Bench bench(inMode("cyclic_velocity"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.coast = 3000;
  const ProcedureStatus& status = bench.perform(ProcedureKind::halt);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("halt did not bring the axis to standstill"));
  EXPECT_THAT(status.message, HasSubstr("quick stop is commanded"));
  bench.run(milliseconds(8));
  EXPECT_EQ(bench.drive.controlword, 0x0002);
}

TEST(HaltProcedure, OfADisabledAxisHasNothingToDo) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  EXPECT_EQ(bench.perform(ProcedureKind::halt).message,
            "shoulder: is not enabled, so nothing is to be halted");
}

}  // namespace
}  // namespace cia402::drive
