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

TEST(EnableProcedure, WritesBeforeEnableParametersFirst) {
  DriveProfile profile = testProfile();
  NamedWrite option;
  option.object = "quick_stop_option";
  option.raw = 2;
  profile.before_enable = {option};
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.writes.clear();
  ASSERT_TRUE(bench.enable());
  ASSERT_EQ(bench.drive.writes.size(), 1u);
  EXPECT_EQ(bench.drive.writes[0], (std::pair<unsigned, std::uint64_t>(0x605A, 2)));
}

TEST(EnableProcedure, ARefusedParameterFailsWithTheDrivesAnswer) {
  DriveProfile profile = testProfile();
  NamedWrite option;
  option.object = "quick_stop_option";
  option.raw = 2;
  profile.before_enable = {option};
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.aborts[{0x605A, 0}] = 0x06090030;
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("shoulder (node 3): "));
  EXPECT_THAT(status.message, HasSubstr("605A:00"));
  EXPECT_THAT(status.message, HasSubstr("0x06090030"));
  EXPECT_EQ(bench.drive.controlword, 0x0000);
}

TEST(EnableProcedure, OptionalParametersMayBeRefused) {
  DriveProfile profile = testProfile();
  NamedWrite option;
  option.object = "quick_stop_option";
  option.raw = 2;
  option.optional = true;
  profile.before_enable = {option};
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.aborts[{0x605A, 0}] = 0x06020000;
  EXPECT_TRUE(bench.enable());
}

TEST(EnableProcedure, ATimeOutNamesTransitionControlwordPdoStatuswordAndEmergency) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(FakeDrive::S::on);
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("shoulder (node 3): enabling timed out: the drive has been "
                                        "in switched on for 2"));
  EXPECT_THAT(status.message,
              HasSubstr("controlword 6040:00 = 0x000F, enable operation (transition 4)"));
  EXPECT_THAT(status.message, HasSubstr("sent in RPDO 1 (COB-ID 0x203), "));
  EXPECT_THAT(status.message, HasSubstr("statusword 0x0233 (switched on: ready to switch on, "
                                        "switched on, voltage enabled, quick stop inactive, "
                                        "remote)"));
  EXPECT_THAT(status.message, HasSubstr("no EMCY is pending"));
  bench.drive.stuck.clear();
  bench.run(milliseconds(50));
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
}

TEST(EnableProcedure, ATimeOutWithoutSupplyPointsToIt) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.voltage = false;
  bench.drive.stuck.insert(FakeDrive::S::disabled);
  EXPECT_THAT(bench.perform(ProcedureKind::enable).message,
              HasSubstr("voltage enabled is 0: check the main supply"));
}

TEST(EnableProcedure, WaitsForSlowModeChangesWhateverIsShownBetween) {
  DriveProfile profile = testProfile();
  profile.timing.mode_change = std::chrono::seconds(5);
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.mode = 1;
  bench.drive.mode_delay = 750;  // 3 s of -1
  bool enabled_too_early = false;
  bench.each_cycle = [&] {
    enabled_too_early |= bench.drive.controlword != 0 && bench.drive.mode != 8;
  };
  EXPECT_TRUE(bench.enable());
  EXPECT_FALSE(enabled_too_early);
}

TEST(EnableProcedure, AModeThatNeverShowsFailsBeforeThePowerStageIsOn) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.mode = 1;
  bench.drive.mode_delay = 100000;
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("mode cyclic_position was not taken: 6061:00 mode display "
                                        "shows -1"));
  EXPECT_THAT(status.message, HasSubstr("after 6060:00 was set to 8 (cyclic_position)"));
  EXPECT_EQ(bench.drive.controlword, 0x0000);
}

TEST(EnableProcedure, WritesTheModeBySdoWhereItIsNotMapped) {
  test::Layout layout = test::testLayout();
  layout.inputs[0].objects.pop_back();  // 6061h
  Bench bench(testConfig(), layout);
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.enable()) << "6061h is read by SDO";
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_position");
}

TEST(EnableProcedure, RefusesAFaultedAxisWithTheRemedy) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.fail(0x8611);
  bench.run(milliseconds(40));
  EXPECT_THAT(bench.refusal(ProcedureKind::enable),
              HasSubstr("cannot enable: shoulder (node 3): fault 0x8611 following error"));
}

TEST(EnableProcedure, AFaultOnTheWayFailsIt) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(FakeDrive::S::ready);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0}, bench.now).ok());
  bench.run(milliseconds(100));
  bench.fail(0x3220);
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_FALSE(bench.axis.procedure().success);
  EXPECT_THAT(bench.axis.procedure().message, HasSubstr("shoulder (node 3): fault 0x3220"));
}

TEST(EnableProcedure, RefusesANodeThatIsNotReady) {
  Bench bench;
  EXPECT_THAT(bench.refusal(ProcedureKind::enable),
              HasSubstr("shoulder (node 3): cannot enable: the node is absent"));
}

TEST(EnableProcedure, RefusesAModeWhoseTargetIsNotMapped) {
  AxisConfig config = testConfig();
  config.mode = "interpolated_position";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  EXPECT_THAT(bench.refusal(ProcedureKind::enable),
              HasSubstr("its target 60C1:01 interpolation_target is not mapped into an RPDO"));
}

TEST(EnableProcedure, LeavesQuickStopActiveByTransition16WhereTheDriveHolds) {
  DriveProfile profile = testProfile();
  profile.quick_stop_holds = {5, 6, 7};
  Bench bench(testConfig(profile));
  bench.drive.dictionary[{0x605A, 0}] = {6, 2};
  bench.drive.quick_stop_ends = false;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  EXPECT_THAT(bench.perform(ProcedureKind::quick_stop).message,
              HasSubstr("holds its position in quick stop active"));
  bench.drive.controlwords.clear();
  ASSERT_TRUE(bench.enable());
  EXPECT_EQ(bench.drive.controlwords, (std::vector<std::uint16_t>{0x000F}));
}

TEST(EnableProcedure, LeavesQuickStopActiveByDisablingWhereTheDriveDoesNotHold) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.quick_stop_ends = false;
  bench.drive.state = FakeDrive::S::quick;
  bench.drive.stuck.insert(FakeDrive::S::quick);
  bench.run(milliseconds(20));
  bench.drive.stuck.clear();
  ASSERT_TRUE(bench.enable());
  EXPECT_EQ(bench.drive.controlwords,
            (std::vector<std::uint16_t>{0x0000, 0x0002, 0x0000, 0x0006, 0x0007, 0x000F}));
}

TEST(EnableProcedure, AnEnabledAxisSaysSo) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  EXPECT_EQ(bench.perform(ProcedureKind::enable).message,
            "shoulder: is enabled already, mode cyclic_position");
}

TEST(EnableProcedure, CancellingItSwitchesOff) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(FakeDrive::S::on);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0}, bench.now).ok());
  bench.run(milliseconds(100));
  bench.drive.stuck.clear();
  bench.axis.cancel("the caller went away", bench.now);
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
  EXPECT_THAT(bench.axis.procedure().message, HasSubstr("enable was cancelled: the caller went"));
}

}  // namespace
}  // namespace cia402::drive
