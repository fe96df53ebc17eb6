// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What procedures tell people while they run, and how long they wait.
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
using testing::Contains;
using testing::Not;
using S = FakeDrive::S;
using Steps = std::vector<std::string>;
using namespace std::chrono_literals;

AxisConfig startsIn(const std::string& mode, DriveProfile profile = testProfile()) {
  AxisConfig config = testConfig(std::move(profile));
  config.mode = mode;
  return config;
}

TEST(ProcedureSteps, OfAnythingBeginWithStarting) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  for (const auto kind : {ProcedureKind::enable, ProcedureKind::disable, ProcedureKind::halt}) {
    ASSERT_TRUE(bench.axis.start({kind, {}, 0.0}, bench.now).ok());
    EXPECT_TRUE(bench.axis.procedure().running);
    EXPECT_EQ(bench.axis.procedure().step, "starting");
    bench.run(1s);
  }
}

TEST(ProcedureSteps, OfDisableNameTheStateThatIsAwaited) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(100ms);
  EXPECT_EQ(stepsOf(bench, ProcedureKind::disable),
            (Steps{"switching off | the drive to show switch on disabled"}));
  EXPECT_FALSE(bench.axis.procedure().remark) << "there is nothing more to say";
}

TEST(ProcedureSteps, DisableGivesBothStatesTheirTime) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(100ms);
  bench.drive.stuck.insert(S::enabled);
  const Time began = bench.now;
  EXPECT_FALSE(bench.perform(ProcedureKind::disable).success);
  EXPECT_GE(bench.now - began, 4s) << "transitions 5 and 7 of 2 s each";
}

TEST(ProcedureSteps, DisableOfAFaultedAxisSaysWhichFaultItIs) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.fail(0x8611);
  bench.run(200ms);
  const ProcedureStatus& status = bench.perform(ProcedureKind::disable);
  EXPECT_TRUE(status.success);
  EXPECT_TRUE(status.remark);
  EXPECT_THAT(status.message, HasSubstr("shoulder: disabled; shoulder (node 3): fault 0x8611"));
}

TEST(ProcedureSteps, DisableWaitsForAnAxisThatCoasts) {
  for (const auto coasting : {8s, 20s}) {
    SCOPED_TRACE(coasting.count());
    Bench bench;
    ASSERT_TRUE(bench.boot());
    bench.drive.coast = 5000;
    bench.run(200ms);
    const Time began = bench.now;
    bench.each_cycle = [&] { bench.drive.coast = bench.now - began < coasting ? 5000 : 0; };
    EXPECT_EQ(stepsOf(bench, ProcedureKind::disable),
              (Steps{"coasting | the axis to come to rest; its power is off, nothing brakes it"}));
    EXPECT_EQ(bench.axis.procedure().success, coasting < 10s);
    if (coasting > 10s) {
      EXPECT_GE(bench.now - began, 10s);
      EXPECT_THAT(bench.axis.procedure().message,
                  HasSubstr("is disabled, but after 10 s the axis still moves (velocity 0.500)"));
    }
  }
}

TEST(ProcedureSteps, OfAQuickStopGiveTheDriveTimeToSwitchOff) {
  Bench bench;
  bench.drive.quick_stop_ends = false;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(100ms);
  const Time began = bench.now;
  EXPECT_THAT(stepsOf(bench, ProcedureKind::quick_stop),
              Contains("stopped | the drive to switch off or to hold (605A:00 quick stop option)"));
  EXPECT_GE(bench.now - began, 1s)
      << "half the time of a state change, the other for transition 12";
  EXPECT_LT(bench.now - began, 2s);
  EXPECT_TRUE(bench.axis.procedure().remark);
}

TEST(ProcedureSteps, OfAHaltNameStandstill) {
  Bench bench(startsIn("cyclic_velocity"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.follow(1.0);
  bench.run(200ms);
  bench.each_cycle = nullptr;
  EXPECT_EQ(stepsOf(bench, ProcedureKind::halt), (Steps{"halting | standstill"}));
}

TEST(ProcedureSteps, AHaltThatFailsTellsHowLongItWaited) {
  Bench bench(startsIn("cyclic_velocity"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(1s);
  bench.drive.coast = 3000;
  bench.run(20ms);
  const Time began = bench.now;
  EXPECT_THAT(bench.perform(ProcedureKind::halt).message, HasSubstr("to standstill within 2 s"));
  EXPECT_NEAR(toSeconds(bench.now - began), 2.0, 0.02);
}

TEST(ProcedureSteps, AHaltOfAnAxisThatIsBeingSwitchedOnSwitchesItOff) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(S::on);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.state == S::on; }));
  const ProcedureStatus& status = bench.perform(ProcedureKind::halt);
  EXPECT_TRUE(status.success);
  EXPECT_TRUE(status.remark);
  EXPECT_EQ(status.message, "shoulder: was being enabled, is switched off again instead");
  bench.drive.stuck.clear();
  bench.run(40ms);
  EXPECT_EQ(bench.drive.state, S::disabled);
}

TEST(ProcedureSteps, OfEnableOnAHaltedAxisNameTheSetPoint) {
  Bench bench(startsIn("profile_position"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.axis.setTarget(3.0));
  bench.run(100ms);
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  EXPECT_EQ(stepsOf(bench, ProcedureKind::enable),
            (Steps{"writing position limits | the drive to hold the axis also beyond its limits",
                   "releasing the halt | the drive to take its present position as set-point"}));
  EXPECT_EQ(bench.axis.procedure().message,
            "shoulder: the halt is released, the axis holds its position");
}

TEST(ProcedureSteps, EnableSaysThatItBroughtTheAxisIntoItsMode) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.commanded_mode = bench.drive.mode = 3;  // by itself
  bench.drive.mode_delay = 1000000;
  bench.run(8ms);
  bench.each_cycle = [&] {
    if (bench.axis.procedure().step == "switching the mode") bench.drive.mode_delay = 0;
  };
  EXPECT_EQ(bench.perform(ProcedureKind::enable).message,
            "shoulder: is enabled and brought into mode cyclic_position");
}

TEST(ProcedureSteps, EnableReleasesAHomingThatIsHaltedThoughTheDriveTakesNoModeWhileHalted) {
  DriveProfile profile = testProfile();
  profile.mode_change.while_halted = false;
  AxisConfig config = testConfig(profile);
  config.homing = HomingOptions();
  config.homing->method = 17;
  Bench bench(config);
  bench.drive.never_homes = true;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::home, {}, 0.0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.velocity < 0; }));
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  ASSERT_NE(bench.drive.controlword & 0x0100, 0);
  bool under_halt = false;
  bench.each_cycle = [&] {
    under_halt |= (bench.drive.controlword & 0x0100) != 0 && bench.drive.commanded_mode != 6;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_FALSE(under_halt);
  EXPECT_EQ(bench.drive.mode, 8);
}

TEST(ProcedureSteps, AHaltedAxisInAnotherModeIsNotSwitchedWhileTheDriveTakesNone) {
  DriveProfile profile = testProfile();
  profile.mode_change.while_halted = false;
  Bench bench(startsIn("profile_position", profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  bench.drive.commanded_mode = bench.drive.mode = 3;  // by itself
  bench.drive.mode_delay = 1000000;
  bench.run(8ms);
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("takes no mode while halted: disable, then enable"));
}

TEST(ProcedureSteps, HomeNeedsTheHaltReleasedWhereTheDriveTakesNoModeWhileHalted) {
  DriveProfile profile = testProfile();
  profile.mode_change.while_halted = false;
  AxisConfig config = startsIn("profile_position", profile);
  config.homing = HomingOptions();
  config.homing->method = 17;
  config.homing->required = false;
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  EXPECT_THAT(bench.axis.refusal({ProcedureKind::home, {}, 0.0}),
              HasSubstr("cannot home: it is halted, and the drive takes no mode then; enable"));
  ASSERT_TRUE(bench.enable());
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  EXPECT_EQ(bench.drive.homings, 1);
}

TEST(ProcedureSteps, OfSetPositionOpenTheLimitsAndCloseThem) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.run(100ms);
  EXPECT_EQ(stepsOf(bench, ProcedureKind::set_position, {}, 0.5),
            (Steps{"opening position limits | the drive to let go of those of the old zero",
                   "writing position limits | the drive to take those of the new zero"}));
}

TEST(ProcedureSteps, OfSetPositionGiveUpAGoalThatTheAxisHasNotComeTo) {
  Bench bench(startsIn("profile_position"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.axis.setTarget(3.0));
  bench.run(100ms);
  bench.drive.at_limit = true;
  bench.run(160ms);
  ASSERT_EQ(bench.drive.accepted, (std::vector<std::int32_t>{30000}));
  bench.drive.acknowledge_delay = 100;  // 400 ms
  bool declared_early = false;
  bench.each_cycle = [&] {
    declared_early |= bench.axis.procedure().step == "opening position limits" &&
                      (bench.drive.accepted.size() < 2 || (bench.drive.controlword & 0x0010) != 0);
  };
  const double before = bench.drive.position;
  EXPECT_EQ(stepsOf(bench, ProcedureKind::set_position, {}, 0.5),
            (Steps{"giving up the goal | the axis to stand without one",
                   "opening position limits | the drive to let go of those of the old zero",
                   "writing position limits | the drive to take those of the new zero"}));
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
  EXPECT_FALSE(declared_early) << "the drive would take it for a place of the new zero";
  EXPECT_NEAR(bench.drive.accepted.back(), before, 1.0);
  EXPECT_EQ(bench.drive.position, before);
}

TEST(ProcedureSteps, RecoverBootsANodeThatIsNotReadyOnly) {
  Bench bench;
  const char boots[] = "booting the node | the node to be identified, configured and started";
  const char reads[] = "reading feedback | statusword and position from the drive";
  Steps steps = stepsOf(bench, ProcedureKind::recover);
  ASSERT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
  EXPECT_EQ(steps.front(), boots);
  EXPECT_THAT(steps, Contains(reads));
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  steps = stepsOf(bench, ProcedureKind::recover);
  ASSERT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
  EXPECT_EQ(steps.front(), reads);
  EXPECT_THAT(steps, Not(Contains(boots)));
}

TEST(ProcedureSteps, RecoverResetsTheCommunicationOfANodeThatItBoots) {
  Bench bench;
  const auto before = bench.device().bootUps();
  ASSERT_TRUE(bench.perform(ProcedureKind::recover).success);
  EXPECT_EQ(bench.device().bootUps(), before + 1);
}

TEST(ProcedureSteps, RecoverBootsAReadyNodeThatStaysSilentAndThenSaysSo) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.silent = true;
  bench.run(200ms);
  ASSERT_FALSE(bench.axis.state().feedback_valid);
  const Time began = bench.now;
  Time booted{};
  bench.each_cycle = [&] {
    if (booted == Time{} && bench.axis.procedure().step == "booting the node") booted = bench.now;
  };
  const Steps steps = stepsOf(bench, ProcedureKind::recover);
  EXPECT_FALSE(bench.axis.procedure().success);
  EXPECT_GE(booted - began, 2s) << "timing/state_change";
  EXPECT_GE(bench.now - booted, 2s);
  EXPECT_EQ(steps, (Steps{"reading feedback | statusword and position from the drive",
                          "booting the node | the node to be identified, configured and started",
                          "reading feedback | statusword and position from the drive"}));
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("no usable statusword (6041:00) and position (6064:00) within 2"));
}

TEST(ProcedureSteps, RecoverGoesByNothingThatTheDriveSaidBeforeItFellSilent) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(100ms);
  bench.drive.silent = true;  // its last word was "operation enabled"
  bench.run(24ms);
  ASSERT_TRUE(bench.axis.state().feedback_valid) << "not yet stale";
  ASSERT_TRUE(bench.axis.start({ProcedureKind::recover, {}, 0.0}, bench.now).ok());
  EXPECT_TRUE(bench.axis.procedure().running) << bench.axis.procedure().message;
  EXPECT_EQ(bench.axis.procedure().step, "starting");
  bench.cycle();
  EXPECT_EQ(bench.axis.procedure().step, "reading feedback");
  bench.drive.silent = false;
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
}

TEST(ProcedureSteps, NothingIsWaitedForAtTheEnd) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  EXPECT_EQ(bench.perform(ProcedureKind::enable).waiting_for, "");
}

TEST(ProcedureSteps, OfAQuickStopNameItsRamp) {
  Bench bench(startsIn("cyclic_velocity"));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.follow(1.0);
  bench.run(200ms);
  bench.each_cycle = nullptr;
  bench.drive.quick_stop_deceleration = 20000;  // half a second
  EXPECT_THAT(stepsOf(bench, ProcedureKind::quick_stop),
              Contains("stopping | the quick stop ramp to end at standstill"));
}

TEST(ProcedureSteps, OfClearFaultsNameTheStatuswordThatIsMissing) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.silent = true;
  bench.run(40ms);
  EXPECT_THAT(stepsOf(bench, ProcedureKind::clear_faults),
              Contains("waiting for the statusword | the drive to tell whether it has a fault"));
}

}  // namespace
}  // namespace cia402::drive
