// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Axes that are given efforts: how much of it is sent, and what brakes when it ends.
#include <cmath>

#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::Not;

constexpr std::uint16_t kHaltBit = 0x0100;

/// 1 N m is 500 per mille of the rated torque.
AxisConfig pushing(std::optional<StopBy> stop, bool cyclic = true) {
  DriveProfile profile = test::testProfile();
  ModeSpec mode =
      test::modeSpec("torque", cyclic ? 10 : 4, ControlKind::torque, cyclic, "target_torque");
  mode.stop = stop;
  if (stop == StopBy::mode) mode.stop_mode = "cyclic_velocity";
  profile.modes.push_back(mode);
  AxisConfig config = test::testConfig(std::move(profile));
  config.mode = "torque";
  return config;
}

/// The drive does nothing in that mode: the motor turns as the test says.
void turn(FakeDrive& drive, double counts_per_second) {
  drive.coast = counts_per_second / 2;  // counts twice there
}

/// Enabled; pushed with 0.5 N m while it turns at 0.5 rad/s.
struct PushedAxis : Bench {
  explicit PushedAxis(const AxisConfig& config) : Bench(config) {
    EXPECT_TRUE(boot() && enable());
    push();
  }
  void push() {
    turn(drive, 5000);
    follow(0.5);
    run(milliseconds(100));
    EXPECT_EQ(drive.target_torque, 250);
  }
  void letGo() { each_cycle = nullptr; }
};

// In a PDO the drive would ignore it, and push on with the one from before.
TEST(AxisEffort, ThatTheDriveDoesNotTakeIsRefusedInWords) {
  AxisConfig config = pushing(std::nullopt);
  auto profile = std::make_shared<DriveProfile>(*config.profile);
  for (ObjectSpec& spec : profile->objects) {
    if (spec.name == "target_torque") spec.range = ObjectSpec::Range{0, 1000};
  }
  config.profile = profile;
  Bench bench(config);
  ASSERT_TRUE(bench.boot() && bench.enable());
  EXPECT_TRUE(bench.axis.command(2.0, bench.now));
  const auto refused = bench.axis.command(-0.5, bench.now);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              HasSubstr("set-point refused: -0.500 does not fit target_torque (6071:00), which "
                        "takes 0.000 to 2.000"));
  bench.run(milliseconds(20));
  EXPECT_EQ(bench.drive.target_torque, 1000);
}

TEST(AxisEffort, IsTakenUpToItsLimit) {
  Bench bench(pushing(std::nullopt));
  ASSERT_TRUE(bench.boot() && bench.enable());
  EXPECT_TRUE(bench.give(4.0));
  EXPECT_TRUE(bench.give(-4.0));
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
  EXPECT_FALSE(bench.axis.setTarget(4.01));
  EXPECT_FALSE(bench.axis.setTarget(-4.01));
}

TEST(AxisEffort, GetsLessFromNineTenthsOfTheVelocityLimitOn) {
  const struct {
    double velocity;  // counts/s; the limit is 20000
    double effort;    // N m
    int sent;         // per mille
  } cases[] = {{0, 2.0, 1000},  {18000, 2.0, 1000},   {19000, 2.0, 500},    {20000, 2.0, 0},
               {25000, 2.0, 0}, {19000, -2.0, -1000}, {-19000, -2.0, -500}, {-19000, 2.0, 1000}};
  for (const auto& c : cases) {
    SCOPED_TRACE(testing::Message() << c.effort << " N m at " << c.velocity);
    Bench bench(pushing(std::nullopt));
    ASSERT_TRUE(bench.boot() && bench.enable());
    turn(bench.drive, c.velocity);
    bench.follow(c.effort);
    bench.run(milliseconds(40));
    EXPECT_EQ(bench.drive.target_torque, c.sent);
  }
}

TEST(AxisEffort, IsSentAsGivenWhereThereIsNoVelocityLimit) {
  AxisConfig config = pushing(std::nullopt);
  config.limits.velocity.reset();
  Bench bench(config);
  ASSERT_TRUE(bench.boot() && bench.enable());
  turn(bench.drive, 25000);
  bench.follow(2.0);
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.drive.target_torque, 1000);
}

TEST(AxisEffort, BeyondAPositionLimitMayOnlyLeadBackOrGetLess) {
  Bench bench(pushing(std::nullopt));
  bench.drive.position = 31000;
  ASSERT_TRUE(bench.boot() && bench.enable());
  EXPECT_FALSE(bench.give(0.5));
  EXPECT_TRUE(bench.give(-0.5));
  EXPECT_TRUE(bench.give(-0.7));
  bench.drive.position = -31000;
  bench.each_cycle = [&] {
    EXPECT_FALSE(bench.axis.setTarget(-0.7)) << "no less than before";
    EXPECT_TRUE(bench.axis.setTarget(-0.6));
    EXPECT_TRUE(bench.axis.setTarget(0.5));
  };
  bench.cycle();
}

TEST(AxisEffort, OfAnAxisThatIsNotHomedKnowsNoPositionLimits) {
  AxisConfig config = pushing(std::nullopt);
  config.homing = HomingOptions();
  config.homing->method = 17;
  Bench bench(config);
  bench.drive.position = 32000;
  ASSERT_TRUE(bench.boot() && bench.enable());
  ASSERT_FALSE(bench.axis.state().homed);
  EXPECT_TRUE(bench.give(0.5));
  EXPECT_TRUE(bench.give(-0.5));
}

TEST(EffortStream, ThatEndsInMotionIsBrakedByTheHaltBitUntilTheNextEffort) {
  PushedAxis axis(pushing(std::nullopt, false));
  axis.letGo();
  axis.run(milliseconds(12));
  EXPECT_EQ(axis.drive.controlword, 0x000F | kHaltBit);
  EXPECT_EQ(axis.drive.target_torque, 0);
  EXPECT_FALSE(axis.axis.state().halted) << "it takes the next effort";
  axis.run(milliseconds(300));
  EXPECT_EQ(axis.drive.controlword, 0x000F | kHaltBit) << "the motor turns still";
  EXPECT_TRUE(axis.give(0.5));
  axis.cycle();
  EXPECT_EQ(axis.drive.controlword, 0x000F);
  EXPECT_EQ(axis.axis.noticeCount(), 0u);
}

TEST(EffortStream, ItsBrakeEndsWithItsMode) {
  PushedAxis axis(pushing(std::nullopt, false));
  axis.letGo();
  axis.run(milliseconds(40));
  turn(axis.drive, 0);
  axis.run(milliseconds(200));
  ASSERT_EQ(axis.drive.controlword, 0x000F | kHaltBit);
  ASSERT_TRUE(axis.perform(ProcedureKind::set_mode, "csv").success);
  EXPECT_EQ(axis.drive.controlword, 0x000F);
}

TEST(EffortStream, ThatEndsAtRestNeedsNoBrake) {
  PushedAxis axis(pushing(StopBy::quick_stop));
  turn(axis.drive, 0);
  axis.run(milliseconds(150));
  axis.follow(0.0);
  axis.run(milliseconds(150));
  axis.letGo();
  axis.run(milliseconds(40));
  turn(axis.drive, 5000);  // by hand, later
  axis.run(milliseconds(40));
  EXPECT_EQ(axis.drive.controlword, 0x000F);
  EXPECT_TRUE(axis.axis.state().ready_for_motion);
}

TEST(EffortStream, ThatEndsLetsTheAxisCoastWhereThatIsAskedFor) {
  for (const StopBy stop : {StopBy::halt, StopBy::quick_stop, StopBy::mode}) {
    AxisConfig config = pushing(stop);
    config.brake_after_effort = false;
    PushedAxis axis(config);
    axis.letGo();
    axis.run(milliseconds(100));
    EXPECT_EQ(axis.drive.controlword, 0x000F);
    EXPECT_EQ(axis.drive.commanded_mode, 10);
    EXPECT_EQ(axis.drive.target_torque, 0);
    EXPECT_TRUE(axis.axis.state().ready_for_motion);
  }
}

TEST(EffortStream, ThatEndsIsBrakedByAQuickStopWhereNothingElseBrakes) {
  PushedAxis axis(pushing(StopBy::quick_stop));
  axis.letGo();
  axis.run(milliseconds(12));
  EXPECT_EQ(axis.drive.controlword, 0x0002);
  EXPECT_FALSE(axis.axis.state().ready_for_motion);
  EXPECT_THAT(axis.axis.notice(), HasSubstr("the stream of efforts ended"));
  EXPECT_THAT(axis.axis.notice(), HasSubstr("braked by a quick stop, as mode torque has no other"));
  EXPECT_EQ(axis.axis.noticeCount(), 1u);
}

TEST(EffortStream, KeepsTheMeasuredVelocityReadyForTheModeThatBrakes) {
  PushedAxis axis(pushing(StopBy::mode));
  EXPECT_EQ(axis.drive.target_velocity, 5000);
  turn(axis.drive, -3000);
  axis.run(milliseconds(16));
  EXPECT_EQ(axis.drive.target_velocity, -3000);
}

// Nothing is braked before the drive has taken the mode: the ramp would be over by then.
TEST(EffortStream, ThatEndsIsRampedToRestByTheModeThatBrakesOnceThatIsShown) {
  PushedAxis axis(pushing(StopBy::mode));
  axis.drive.mode_delay = 25;  // 100 ms
  // Begun anew in each cycle, of which a ramp of 8 rad/s^2 takes 320 counts/s.
  axis.each_cycle = [&] { EXPECT_GE(axis.drive.target_velocity, 5000 - 320); };
  axis.run(milliseconds(80));
  axis.each_cycle = nullptr;
  EXPECT_EQ(axis.drive.commanded_mode, 9);
  EXPECT_EQ(axis.drive.target_torque, 0);
  EXPECT_EQ(axis.drive.controlword, 0x000F);
  EXPECT_THAT(axis.axis.notice(), HasSubstr("braked and held by mode cyclic_velocity"));
  EXPECT_THAT(axis.axis.notice(),
              HasSubstr("enable takes it back into torque: enable to go on, or let it coast by "));
  ASSERT_TRUE(axis.runUntil([&] { return axis.drive.mode == 9; }, milliseconds(40)));
  turn(axis.drive, 0);
  const Time taken = axis.now;
  ASSERT_TRUE(axis.runUntil([&] { return axis.drive.target_velocity == 0; }, milliseconds(500)));
  // 0.5 rad/s at 8 rad/s^2: 62.5 ms, less the step that it has, and what the wire takes.
  EXPECT_GE(axis.now - taken, milliseconds(56));
  EXPECT_LE(axis.now - taken, milliseconds(76));
  axis.run(milliseconds(1500));
  EXPECT_EQ(axis.drive.controlword, 0x000F) << "held under power";
  EXPECT_TRUE(axis.axis.state().halted);
  EXPECT_FALSE(axis.axis.state().ready_for_motion);
  EXPECT_EQ(axis.axis.obstacle(), "shoulder is halted: enable");
  EXPECT_EQ(axis.axis.noticeCount(), 1u);
  EXPECT_TRUE(axis.perform(ProcedureKind::enable).success) << axis.axis.procedure().message;
  EXPECT_EQ(axis.drive.commanded_mode, 10);
  EXPECT_TRUE(axis.axis.state().ready_for_motion);
}

TEST(EffortStream, ThatEndsIsQuickStoppedWhereTheModeThatBrakesIsNotTaken) {
  PushedAxis axis(pushing(StopBy::mode));
  axis.drive.mode_delay = 100000;
  axis.letGo();
  axis.run(milliseconds(1000));  // Timing::mode_change
  EXPECT_EQ(axis.drive.controlword, 0x000F);
  axis.run(milliseconds(20));
  EXPECT_EQ(axis.drive.controlword, 0x0002);
  EXPECT_THAT(axis.axis.notice(),
              HasSubstr("mode cyclic_velocity (6060:00 = 9), which is to brake, "
                        "was not taken within 1 s; quick stop is commanded"));
}

TEST(EffortStream, ThatEndsIsQuickStoppedWhereTheTargetOfTheModeThatBrakesIsMissing) {
  PushedAxis axis(pushing(StopBy::mode));
  axis.device().leaveOut({0x60FF, 0});
  axis.letGo();
  axis.run(milliseconds(12));
  EXPECT_EQ(axis.drive.controlword, 0x0002);
  EXPECT_EQ(axis.drive.commanded_mode, 10);
  EXPECT_THAT(axis.axis.notice(), HasSubstr("braked by a quick stop, as mode torque has no other"));
}

// The place of 6060h among the outputs has another object, and what the drive shows is sent by the
// test.
TEST(EffortStream, ThatEndsHasTheModeThatBrakesWrittenWhereNoRpdoBringsIt) {
  test::Layout layout = test::testLayout();
  layout.outputs[0].objects[1] = {{0x6098, 0}, 8};
  Bench bench(pushing(StopBy::mode), layout);
  ASSERT_TRUE(bench.boot());
  bench.drive.silent = true;
  bool pushed = true;
  bench.each_cycle = [&] {
    const auto mode = static_cast<std::uint8_t>(bench.drive.dictionary[{0x6060, 0}].first);
    bench.bring(
        {{{0x6041, 0}, bench.drive.statusword()}, {{0x6064, 0}, 12345}, {{0x6061, 0}, mode}});
    bench.bring({{{0x606C, 0}, 5000}, {{0x6077, 0}, 0}, {{0x603F, 0}, 0}});
    if (pushed) static_cast<void>(bench.axis.setTarget(0.5));
  };
  ASSERT_TRUE(bench.enable());
  bench.run(milliseconds(40));
  ASSERT_EQ(bench.drive.target_torque, 250);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::halt, {}, 0.0}, bench.now).ok());
  pushed = false;
  bench.run(milliseconds(12));
  EXPECT_EQ(bench.drive.dictionary[std::make_pair(0x6060u, 0u)].first, 9u);
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_velocity");
  EXPECT_EQ(bench.drive.controlword, 0x000F);
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.target_velocity == 0; }, milliseconds(100)));
}

TEST(EffortHalt, StopsByTheModeThatBrakesAndStaysEnabled) {
  PushedAxis axis(pushing(StopBy::mode));
  axis.letGo();
  ASSERT_TRUE(axis.axis.start({ProcedureKind::halt, {}, 0.0}, axis.now).ok());
  axis.run(milliseconds(12));
  EXPECT_EQ(axis.drive.commanded_mode, 9);
  EXPECT_EQ(axis.drive.target_torque, 0);
  turn(axis.drive, 0);
  ASSERT_TRUE(axis.runUntil([&] { return !axis.axis.procedure().running; }));
  EXPECT_TRUE(axis.axis.procedure().success) << axis.axis.procedure().message;
  EXPECT_EQ(axis.drive.controlword, 0x000F);
  EXPECT_TRUE(axis.axis.state().halted);
}

TEST(EffortHalt, StopsByAQuickStopWhereNothingElseBrakes) {
  for (const bool missing : {false, true}) {
    PushedAxis axis(pushing(missing ? StopBy::mode : StopBy::quick_stop));
    if (missing) axis.device().leaveOut({0x60FF, 0});
    axis.letGo();
    ASSERT_TRUE(axis.axis.start({ProcedureKind::halt, {}, 0.0}, axis.now).ok());
    axis.run(milliseconds(12));
    EXPECT_EQ(axis.drive.controlword, 0x0002);
    turn(axis.drive, 0);
    ASSERT_TRUE(axis.runUntil([&] { return !axis.axis.procedure().running; }));
    EXPECT_TRUE(axis.axis.procedure().success);
    EXPECT_THAT(axis.axis.procedure().message,
                HasSubstr("stopped by a quick stop, as mode torque has no other brake"));
  }
}

}  // namespace
}  // namespace cia402::drive
