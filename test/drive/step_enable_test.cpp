// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What switching on waits for.
#include <algorithm>
#include <cmath>

#include "drive/procedure_steps.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;
using S = FakeDrive::S;
using namespace std::chrono_literals;

TEST(EnableStep, WaitsUntilAnAxisThatCoastsStands) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.coast = 5000;  // counts/s, 0.5 rad/s
  bench.run(200ms);
  bool on_in_motion = false;
  const Time rests = bench.now + 3s;
  bench.each_cycle = [&] {
    if (bench.now >= rests) bench.drive.coast = 0;
    on_in_motion |= bench.drive.velocity != 0 && bench.drive.state != S::disabled;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_FALSE(on_in_motion);
  EXPECT_GT(bench.now, rests);
}

TEST(EnableStep, SaysSoWhereTheAxisDoesNotComeToRest) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.coast = 5000;
  const Time began = bench.now;
  bool on = false;
  bench.each_cycle = [&] { on |= bench.drive.state != S::disabled; };
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_FALSE(on);
  EXPECT_GE(bench.now - began, 10s);
  EXPECT_THAT(status.message,
              HasSubstr("shoulder (node 3): is not switched on, for it still moves after 10"));
  EXPECT_THAT(status.message, HasSubstr("velocity 0.5"));
}

TEST(EnableStep, GoesByNothingThatADriveSaidBeforeItFellSilent) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(100ms);
  bench.axis.onBusLost("can0 was bus-off for a moment");
  bench.drive.silent = true;  // its last word was "operation enabled"
  bench.drive.state = S::disabled;
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("no usable statusword"));
}

TEST(EnableStep, LooksAgainOnceTheModeIsThere) {
  DriveProfile profile = testProfile();
  profile.timing.mode_change = 5s;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.mode = 1;
  bench.drive.mode_delay = 250;  // 1 s
  bool on_in_motion = false;
  const Time began = bench.now;
  bench.each_cycle = [&] {  // somebody pushes it meanwhile
    const bool pushed = bench.now > began + 500ms && bench.now < began + 2s;
    bench.drive.coast = pushed ? 5000 : 0;
    on_in_motion |= bench.drive.velocity != 0 && bench.drive.state != S::disabled;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_FALSE(on_in_motion);
}

TEST(EnableStep, LeavesAQuickStopThatStillBrakesItsTime) {
  AxisConfig config = testConfig();
  config.mode = "cyclic_velocity";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.follow(1.0);
  bench.run(200ms);
  bench.each_cycle = nullptr;
  bench.drive.quick_stop_deceleration = 10000;  // 1 s from 1 rad/s
  ASSERT_TRUE(bench.axis.start({ProcedureKind::quick_stop, {}, 0}, bench.now).ok());
  bench.run(100ms);
  bench.axis.cancel("the caller went away", bench.now);
  double last = bench.drive.velocity, hardest = 0.0;
  bench.each_cycle = [&] {
    hardest = std::max(hardest, std::fabs(bench.drive.velocity - last) / 0.004);
    last = bench.drive.velocity;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_LT(hardest, 10001.0) << "counts/s^2, the ramp of the drive";
}

TEST(EnableStep, TellsWhatItWaitsFor) {
  DriveProfile profile = testProfile();
  profile.timing.brake_release = 250ms;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  EXPECT_EQ(test::stepsOf(bench, ProcedureKind::enable),
            (std::vector<std::string>{
                "waiting for standstill | the axis to stand, before the power comes",
                "writing position limits | the drive to take the joint's limits",
                "setting the target to the actual value | its RPDO to be sent",
                "switching the mode | 6061:00 to show 8 (cyclic_position)",
                "switching on | the drive to leave switch on disabled",
                "switching on | the drive to leave ready to switch on",
                "switching on | the drive to leave switched on",
                "releasing the brake | 0.25 s to pass (profile, brake_release)"}));
}

TEST(EnableStep, IsDoneOnceTheBrakeIsReleased) {
  DriveProfile profile = testProfile();
  profile.timing.brake_release = 500ms;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  Time enabled{};
  bench.each_cycle = [&] {
    if (enabled == Time{} && bench.drive.state == S::enabled) enabled = bench.now;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_GE(bench.now - enabled, 500ms);
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
}

TEST(EnableStep, WaitsForFeedbackAsLongAsAStateMayTakeToChange) {
  for (const auto silence : {1500ms, 2500ms}) {
    SCOPED_TRACE(silence.count());
    Bench bench;
    ASSERT_TRUE(bench.boot());
    bench.drive.silent = true;
    bench.run(200ms);
    ASSERT_FALSE(bench.axis.state().feedback_valid);
    const Time began = bench.now;
    bench.each_cycle = [&] { bench.drive.silent = bench.now - began < silence; };
    const std::vector<std::string> steps = test::stepsOf(bench, ProcedureKind::enable);
    ASSERT_FALSE(steps.empty());
    EXPECT_EQ(steps[0], "reading feedback | statusword and position from the drive");
    const ProcedureStatus& status = bench.axis.procedure();
    EXPECT_EQ(status.success, silence < 2s) << status.message;
    if (silence > 2s) {
      EXPECT_GE(bench.now - began, 2s);
      EXPECT_THAT(status.message, HasSubstr("no usable statusword (6041:00) and position (6064:00) "
                                            "within 2"));
    }
  }
}

TEST(EnableStep, SaysSoWhereTheAxisIsPushedAwayOnceTheModeIsThere) {
  DriveProfile profile = testProfile();
  profile.timing.mode_change = 5s;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.mode = 1;
  bench.drive.mode_delay = 250;  // 1 s
  const Time began = bench.now;
  bench.each_cycle = [&] { bench.drive.coast = bench.now > began + 500ms ? 5000 : 0; };
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("is not switched on, for it still moves after 10"));
  EXPECT_EQ(bench.drive.state, S::disabled);
}

TEST(EnableStep, AFaultOfAnAxisThatCoastsIsToldAtOnce) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.coast = 5000;
  bench.run(200ms);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  bench.run(100ms);
  bench.fail(0x8611);
  bench.run(20ms);
  EXPECT_FALSE(bench.axis.procedure().running);
  EXPECT_THAT(bench.axis.procedure().message, HasSubstr("fault 0x8611 following error"));
}

TEST(EnableStep, AnAxisThatADriveHoldsByAQuickStopGoesOnWithTheParametersThatItHas) {
  DriveProfile profile = testProfile();
  profile.quick_stop_holds = {6};
  profile.mode_change.needs_disabling = true;
  NamedWrite option;
  option.object = "quick_stop_option";
  option.raw = 6;
  profile.before_enable = {option};
  AxisConfig config = testConfig(profile);
  config.quick_stop_holds = true;
  Bench bench(config);
  bench.drive.dictionary[{0x605A, 0}] = {6, 2};
  bench.drive.quick_stop_ends = false;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::quick_stop).success);
  ASSERT_EQ(bench.drive.state, S::quick);
  bench.drive.writes.clear();
  bench.drive.controlwords.clear();
  EXPECT_TRUE(bench.enable());
  EXPECT_TRUE(bench.drive.writes.empty()) << "it takes none under power";
  EXPECT_EQ(bench.drive.controlwords, (std::vector<std::uint16_t>{0x000F}));
}

TEST(EnableStep, AQuickStopThatTheDriveBeginsByItselfIsNotCutShort) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(S::on);
  Time on{};
  bool let_go = false;
  bench.each_cycle = [&] {
    if (on == Time{} && bench.drive.state == S::on) {
      on = bench.now;
      bench.drive.coast = 5000;
    }
    if (on != Time{} && bench.drive.stuck.count(S::on) != 0 && bench.now - on >= 40ms) {
      bench.drive.stuck = {S::quick};
      bench.drive.state = S::quick;
    }
    if (on != Time{} && bench.now - on >= 80ms) bench.drive.stuck.clear();
    if (on != Time{} && bench.now - on >= 500ms) bench.drive.coast = 0;
    let_go |= bench.drive.coast != 0 && bench.drive.stuck.empty() && bench.drive.state != S::quick;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_FALSE(let_go);
}

}  // namespace
}  // namespace cia402::drive
