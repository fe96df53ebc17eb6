// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/axis.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;

TEST(Axis, IsRefusedWithoutAMappedStatusword) {
  test::Layout layout = test::testLayout();
  layout.inputs[0].objects.erase(layout.inputs[0].objects.begin());
  EXPECT_THROW(Bench(testConfig(), layout), std::invalid_argument);
}

TEST(Axis, KnowsNothingBeforeTheNodeIsReady) {
  Bench bench;
  bench.run(milliseconds(20));
  const AxisState& state = bench.axis.state();
  EXPECT_FALSE(state.feedback_valid);
  EXPECT_TRUE(std::isnan(state.position));
  EXPECT_TRUE(std::isnan(state.velocity));
  EXPECT_EQ(state.state, State::unknown);
  EXPECT_THAT(bench.axis.motionRefusal(), HasSubstr("shoulder (node 3): the node is"));
}

TEST(Axis, DecodesFeedbackAfterBoot) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.cycle();
  EXPECT_NEAR(bench.axis.state().position, 1.2345, 1e-9);
  EXPECT_EQ(bench.axis.state().state, State::switch_on_disabled);
  EXPECT_EQ(bench.axis.state().stamp, bench.now);
}

TEST(Axis, UntilToldItOnlyStopsADriveThatItFindsEnabled) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.state = FakeDrive::S::enabled;  // by somebody else: not 0x0007, not 0x000F
  bench.drive.stuck.insert(FakeDrive::S::enabled);
  bench.run(milliseconds(500));
  EXPECT_EQ(bench.drive.controlwords, (std::vector<std::uint16_t>{0x0000, 0x0002}));
}

TEST(Axis, APositionWithoutAStatuswordIsNotBelieved) {
  test::Layout layout = test::testLayout();
  layout.inputs[0].objects = {{{0x6041, 0}, 16}};
  layout.inputs.push_back(test::thirdInput({0x6064, 0}, 32));
  Bench bench(testConfig(), layout);
  bench.each_cycle = [&] { bench.bring({0x6064, 0}, 1000); };
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(20));
  EXPECT_NEAR(bench.axis.state().position, 0.1, 1e-9);
  bench.drive.silent = true;
  bench.run(milliseconds(150));
  EXPECT_EQ(bench.axis.state().state, State::unknown);
  EXPECT_FALSE(bench.axis.state().feedback_valid);
  EXPECT_TRUE(std::isnan(bench.axis.state().position));
}

TEST(Axis, TargetFollowsTheActualPositionWhileNotEnabled) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.coast = 5000;  // pushed by hand
  bench.run(milliseconds(400));
  EXPECT_NEAR(bench.drive.target_position, bench.drive.position, 5000 * 0.009);
  EXPECT_GT(bench.drive.position, 13000);
}

TEST(Axis, EnablingStepsThroughEveryStateWithTheTargetAlreadyAtTheActualPosition) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  std::vector<std::int32_t> targets_when_enabled;
  bench.each_cycle = [&] {
    if (bench.drive.state == FakeDrive::S::enabled) {
      targets_when_enabled.push_back(bench.drive.target_position);
    }
  };
  ASSERT_TRUE(bench.enable());
  EXPECT_EQ(bench.drive.controlwords, (std::vector<std::uint16_t>{0x0000, 0x0006, 0x0007, 0x000F}));
  ASSERT_FALSE(targets_when_enabled.empty());
  for (const std::int32_t target : targets_when_enabled) EXPECT_EQ(target, 12345);
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
  EXPECT_EQ(bench.axis.motionRefusal(), "");
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("shoulder: enabled in mode cyclic_position"));
}

TEST(Axis, FollowsSetPointsInCyclicPosition) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.follow(1.25);
  bench.run(milliseconds(20));  // from 1.2345 at 2 rad/s
  EXPECT_DOUBLE_EQ(bench.axis.target(), 1.25);
  EXPECT_EQ(bench.drive.target_position, 12500);
  EXPECT_NEAR(bench.axis.state().position, 1.25, 1e-9);
}

TEST(Axis, RefusesTargetsThatAreNoNumberOrOutOfLimits) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  EXPECT_FALSE(bench.axis.setTarget(1.0));  // not enabled
  ASSERT_TRUE(bench.enable());
  const double before = bench.axis.target();
  EXPECT_FALSE(bench.axis.setTarget(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(bench.axis.setTarget(std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(bench.axis.setTarget(3.11));
  EXPECT_FALSE(bench.axis.setTarget(-3.11));
  EXPECT_DOUBLE_EQ(bench.axis.target(), before);
  EXPECT_TRUE(bench.axis.setTarget(3.1));
}

TEST(Axis, AnAxisOutsideItsLimitsMayComeBackButNotGoFurther) {
  Bench bench;
  bench.drive.position = 32000;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  EXPECT_FALSE(bench.axis.setTarget(3.21));
  EXPECT_TRUE(bench.give(3.195));
  EXPECT_TRUE(bench.give(3.19));
  EXPECT_FALSE(bench.give(3.195));
}

TEST(Axis, RefusesPositionMotionBeforeARequiredHoming) {
  AxisConfig config = testConfig();
  config.homing = HomingOptions();
  config.homing->method = 17;
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  EXPECT_FALSE(bench.axis.state().homed);
  EXPECT_FALSE(bench.axis.setTarget(1.24));
  EXPECT_THAT(bench.axis.motionRefusal(), HasSubstr("shoulder (node 3): not homed"));
}

TEST(Axis, WaitsForTheBrakeBeforeMotion) {
  DriveProfile profile = testProfile();
  profile.timing.brake_release = milliseconds(200);
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.axis.state().state == State::operation_enabled; }));
  const Time enabled = bench.now;
  ASSERT_TRUE(bench.runUntil([&] { return bench.axis.state().ready_for_motion; }));
  EXPECT_GE(bench.now - enabled, milliseconds(200));
  EXPECT_LE(bench.now - enabled, milliseconds(212));
}

TEST(Axis, AFaultDisablesForGoodAndSaysWhy) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.fail(0x8611);
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.axis.state().state, State::fault);
  EXPECT_FALSE(bench.axis.state().ready_for_motion);
  EXPECT_EQ(bench.axis.state().error_code, 0x8611);
  EXPECT_EQ(bench.axis.faultText(),
            "shoulder (node 3): fault 0x8611 following error: the axis is blocked or the gains are "
            "too low; check the mechanics and 6065:00; then clear_faults");
  EXPECT_EQ(bench.axis.noticeCount(), 1u);
  EXPECT_THAT(bench.axis.notice(),
              HasSubstr("shoulder (node 3): the drive left operation enabled"));
  EXPECT_THAT(bench.axis.notice(), HasSubstr("statusword 0x021F (fault reaction active"));
  EXPECT_THAT(bench.axis.notice(), HasSubstr("0x8611 following error"));
  bench.drive.state = FakeDrive::S::disabled;  // however it got out of it
  bench.run(milliseconds(500));
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
  EXPECT_EQ(bench.drive.controlword, 0x0000);
}

TEST(Axis, NeverEnablesAgainByItselfAfterTheDriveSwitchedOff) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.state = FakeDrive::S::disabled;  // STO
  bench.drive.voltage = false;
  bench.run(milliseconds(300));
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
  EXPECT_THAT(bench.axis.notice(), HasSubstr("switch on disabled"));
  EXPECT_THAT(bench.axis.motionRefusal(), HasSubstr("call enable"));
}

TEST(Axis, OneUndecodableStatuswordSwitchesNothingOff) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.silent = true;
  bench.cycle();
  // 0x0002: no state of the table; position and mode as before.
  bench.bring({{{0x6041, 0}, 0x0202}, {{0x6064, 0}, 12345}, {{0x6061, 0}, 8}});
  bench.cycle();
  bench.drive.silent = false;
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.drive.controlword, 0x000F);
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
}

TEST(Axis, SilentFeedbackQuickStopsAnEnabledAxis) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.silent = true;
  bench.run(milliseconds(40));  // ten cycles
  EXPECT_TRUE(bench.axis.state().feedback_valid);
  bench.run(milliseconds(8));
  EXPECT_FALSE(bench.axis.state().feedback_valid);
  EXPECT_TRUE(std::isnan(bench.axis.state().position));
  EXPECT_EQ(bench.drive.controlword, 0x0002);
  EXPECT_THAT(bench.axis.notice(),
              HasSubstr("(6041:00) and position (6064:00): TPDO 1 (COB-ID 0x183) did "
                        "not come for 11 cycles"));
  bench.drive.silent = false;
  bench.run(milliseconds(300));
  EXPECT_FALSE(bench.axis.state().ready_for_motion);
  EXPECT_NE(bench.drive.state, FakeDrive::S::enabled);
}

TEST(Axis, FeedbackThatOnlyComesOnChangeDoesNotGetOld) {
  test::Layout layout = test::testLayout();
  for (test::Group& input : layout.inputs) input.every_cycle = false;
  Bench bench(testConfig(), layout);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.silent = true;
  bench.run(milliseconds(400));
  EXPECT_TRUE(bench.axis.state().feedback_valid);
  EXPECT_EQ(bench.drive.controlword, 0x000F);
}

TEST(Axis, ARebootedDriveIsLeftDisabledAndForgotten) {
  AxisConfig config = testConfig();
  config.homing = HomingOptions();
  config.homing->method = 17;
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.perform(ProcedureKind::set_position, {}, 0.5).success);
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.axis.state().homed);
  bench.reboot();
  EXPECT_FALSE(bench.axis.state().ready_for_motion);
  EXPECT_FALSE(bench.axis.state().homed);
  EXPECT_THAT(bench.axis.notice(), HasSubstr("stays disabled until recover or enable"));
  ASSERT_TRUE(bench.runUntil([&] { return bench.axis.state().feedback_valid; }));
  bench.drive.controlwords.clear();
  bench.run(milliseconds(500));
  EXPECT_EQ(bench.drive.controlwords, std::vector<std::uint16_t>{});
  EXPECT_EQ(bench.drive.controlword, 0x0000);
  EXPECT_NEAR(bench.axis.state().position, 1.2345, 1e-9);  // what was declared is void
}

TEST(Axis, ALostNodeFailsTheRunningProcedure) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(FakeDrive::S::ready);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0}, bench.now).ok());
  bench.run(milliseconds(100));
  bench.reboot();
  bench.cycle();
  EXPECT_FALSE(bench.axis.procedure().running);
  EXPECT_FALSE(bench.axis.procedure().success);
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("enable failed: shoulder (node 3): the node"));
}

TEST(Axis, ReadsByServiceDataObjectWhatIsNotMapped) {
  test::Layout layout = test::testLayout();
  layout.inputs.pop_back();  // velocity, torque, error code
  Bench bench(testConfig(), layout);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.coast = 0;
  bench.run(milliseconds(300));
  EXPECT_NEAR(bench.axis.state().velocity, 0.0, 1e-9);
  bench.fail(0x8611);
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.axis.state().error_code, 0x8611);
}

TEST(Axis, RefusesASecondProcedureWhileOneRunsButAStopPreempts) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(FakeDrive::S::ready);
  const auto first = bench.axis.start({ProcedureKind::enable, {}, 0}, bench.now);
  ASSERT_TRUE(first.ok());
  bench.run(milliseconds(200));
  EXPECT_THAT(bench.refusal(ProcedureKind::recover),
              HasSubstr("shoulder (node 3): recover is refused while enable runs (switching on)"));
  bench.drive.stuck.clear();
  EXPECT_TRUE(bench.perform(ProcedureKind::disable).success);
  EXPECT_EQ(bench.axis.previousProcedure().id, *first);
  EXPECT_FALSE(bench.axis.previousProcedure().success);
  EXPECT_THAT(bench.axis.previousProcedure().message, HasSubstr("enable was stopped by disable"));
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
}

}  // namespace
}  // namespace cia402::drive
