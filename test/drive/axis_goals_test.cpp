// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Targets that the motor does not come to: handed over again, taken back, given up.
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

AxisConfig withMode(const std::string& mode, DriveProfile profile = testProfile()) {
  AxisConfig config = testConfig(std::move(profile));
  config.mode = mode;
  return config;
}

/// Follows positions in a mode in which the motor of the fake drive never moves. Their target
/// travels in the place of the target velocity.
struct HeldAxis : Bench {
  explicit HeldAxis(AxisConfig config = withMode("interpolated_position"), double position = 12345)
      : Bench(std::move(config), layout()) {
    drive.position = position;
    EXPECT_TRUE(boot() && enable());
  }
  static test::Layout layout() {
    test::Layout layout = test::testLayout();
    layout.outputs[1].objects[0] = {{0x60C1, 1}, 32};
    return layout;
  }
  std::int32_t sent() const { return static_cast<std::int32_t>(drive.received.at({0x60C1, 1})); }
  void lead(double value) {
    follow(value);
    run(milliseconds(40));
    each_cycle = nullptr;
    run(milliseconds(40));
    EXPECT_NEAR(axis.target(), value, 1e-6);
  }
};

TEST(GoalAhead, ADriveThatHasYetToSetOffMayMove) {
  Bench bench(withMode("profile_position"));
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.run(milliseconds(200));
  ASSERT_FALSE(bench.axis.mayMove());
  bench.drive.acknowledges = false;
  ASSERT_TRUE(bench.give(1.3));
  bench.run(milliseconds(1000));
  EXPECT_FALSE(bench.axis.state().target_reached) << "what it shows is of the one before";
  EXPECT_TRUE(bench.axis.mayMove());
}

TEST(GoalAhead, ASetPointThatIsNotTakenIsToldAndHandedOverAgainOnce) {
  Bench bench(withMode("profile_position"));
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.drive.acknowledges = false;
  ASSERT_TRUE(bench.give(1.3));
  bench.run(milliseconds(1900));
  EXPECT_EQ(bench.axis.noticeCount(), 0u);
  bench.run(milliseconds(200));  // Timing::state_change: 2 s
  EXPECT_EQ(bench.axis.noticeCount(), 1u);
  EXPECT_THAT(bench.axis.notice(), HasSubstr("did not take the set-point 1.300: waited 2 s for"));
  EXPECT_EQ(bench.drive.controlword & 0x0010, 0);
  bench.drive.acknowledges = true;
  ASSERT_TRUE(bench.give(1.3));
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.drive.accepted, (std::vector<std::int32_t>{13000}));
  ASSERT_TRUE(bench.give(1.3));
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.drive.accepted, (std::vector<std::int32_t>{13000})) << "it has that";
}

TEST(GoalAhead, IsHandedOverWithoutWaitingWhereNothingAcknowledgesIt) {
  DriveProfile profile = testProfile();
  profile.modes[0].set_point_acknowledge_bit.reset();
  profile.modes[0].handover = standardHandover(false);
  Bench bench(withMode("profile_position", std::move(profile)));
  ASSERT_TRUE(bench.boot() && bench.enable());
  ASSERT_TRUE(bench.give(1.3));
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.drive.accepted, (std::vector<std::int32_t>{13000}));
  EXPECT_EQ(bench.drive.controlword & 0x0010, 0);
  ASSERT_TRUE(bench.give(1.2));
  bench.run(milliseconds(2500));
  EXPECT_EQ(bench.drive.accepted, (std::vector<std::int32_t>{13000, 12000}));
  EXPECT_EQ(bench.axis.noticeCount(), 0u);
}

TEST(GoalAhead, OfAnAxisThatIsSwitchedOffIsForgotten) {
  Bench bench(withMode("profile_position"));
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.drive.acknowledges = false;
  ASSERT_TRUE(bench.give(1.3));
  bench.run(milliseconds(100));
  ASSERT_FALSE(bench.axis.state().target_reached);
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  bench.run(milliseconds(40));
  EXPECT_TRUE(std::isnan(bench.axis.target()));
  EXPECT_TRUE(bench.axis.setPoint().atRest());
  EXPECT_TRUE(bench.axis.state().target_reached) << "the drive says so of its own";
}

/// The steps that a procedure shows.
bool showsStep(Bench& bench, const ProcedureRequest& request, const std::string& step) {
  bool shown = false;
  bench.each_cycle = [&] { shown = shown || bench.axis.procedure().step == step; };
  const ProcedureStatus& status = bench.perform(request.kind, request.mode, request.position);
  EXPECT_TRUE(status.success) << status.message;
  bench.each_cycle = nullptr;
  return shown;
}

TEST(GoalAhead, IsGivenUpByAnAxisThatIsHeldWhereItIsDeclaredToStand) {
  Bench bench(withMode("profile_position"));
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.drive.at_limit = true;
  ASSERT_TRUE(bench.give(1.3));
  bench.run(milliseconds(150));
  ASSERT_EQ(bench.drive.accepted_target, 13000);
  EXPECT_TRUE(showsStep(bench, {ProcedureKind::set_position, {}, 0.5}, "giving up the goal"));
  EXPECT_EQ(bench.drive.accepted_target, 12345);
  EXPECT_EQ(bench.axis.setPoint().givenUp(), 1u);
  EXPECT_NEAR(bench.axis.target(), 0.5, 1e-9);
}

TEST(GoalAhead, ThereIsNoneToGiveUpWhereTheDriveFollowsAStream) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  EXPECT_FALSE(showsStep(bench, {ProcedureKind::set_position, {}, 0.5}, "giving up the goal"));
  EXPECT_EQ(bench.axis.setPoint().givenUp(), 0u);
}

// Without power, or in another mode, nothing would hold the motor that lets go of what it strains
// against; and what a drive has planned it may still be on its way back from.
TEST(SwitchingTheMode, TakesAGoalBackThatTheAxisIsKeptFrom) {
  DriveProfile profile = testProfile();
  profile.modes[0].target_reached_bit.reset();  // nothing tells that it is under way
  Bench bench(withMode("profile_position", std::move(profile)));
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.drive.at_limit = true;
  ASSERT_TRUE(bench.give(1.3));
  bench.run(milliseconds(150));
  ASSERT_EQ(bench.drive.accepted_target, 13000);
  const Time asked = bench.now;
  ASSERT_TRUE(bench.axis.start({ProcedureKind::set_mode, "csv", 0.0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.commanded_mode == 9; }))
      << bench.axis.procedure().message;
  EXPECT_EQ(bench.drive.accepted_target, 12345);
  // From the 1 rad/s that it gains at 8 rad/s^2 over 65 mrad: an eighth of a second to turn
  // round, and as long again to come back.
  EXPECT_GE(bench.now - asked, milliseconds(250));
  EXPECT_LE(bench.now - asked, milliseconds(1000));
}

TEST(SwitchingTheMode, TakesAStreamsTargetBackWithoutWaitingForLong) {
  HeldAxis axis;
  axis.lead(1.2445);
  ASSERT_EQ(axis.sent(), 12445);
  std::int32_t last = 0;
  axis.each_cycle = [&] {
    if (axis.drive.commanded_mode == 7) last = axis.sent();
  };
  const Time asked = axis.now;
  ASSERT_TRUE(axis.axis.start({ProcedureKind::set_mode, "csp", 0.0}, axis.now).ok());
  ASSERT_TRUE(axis.runUntil([&] { return axis.drive.commanded_mode == 8; }));
  EXPECT_EQ(last, 12345);
  EXPECT_LE(axis.now - asked, milliseconds(250));
}

TEST(SwitchingTheMode, PutsTheNewTargetOnTheWireFirst) {
  Bench bench(withMode("cyclic_velocity"));
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.follow(0.5);
  bench.run(milliseconds(500));
  bench.each_cycle = nullptr;
  bench.run(milliseconds(300));
  ASSERT_GT(bench.drive.position, 14000);
  std::int32_t last = 0;
  bench.each_cycle = [&] {
    if (bench.drive.commanded_mode == 9) last = bench.drive.target_position;
  };
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csp").success);
  EXPECT_EQ(last, static_cast<std::int32_t>(bench.drive.position));
}

// The drive is told mode 0 on the way to one that it has forgotten; a halt ends that.
TEST(SwitchingTheMode, EndsWhatAnEnablingThatWasCutOffHasTheDriveTold) {
  DriveProfile profile = testProfile();
  profile.mode_change.shown_when_enabled = true;
  profile.mode_change.again = ModeChange::Again::through_zero;
  Bench bench(testConfig(std::move(profile)));
  bench.drive.mode_delay = 150;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] {
    return bench.drive.state == FakeDrive::S::enabled && bench.drive.commanded_mode == 0;
  }));
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  ASSERT_EQ(bench.drive.commanded_mode, 0);
  const ProcedureStatus& status = bench.perform(ProcedureKind::set_mode, "csv");
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_EQ(bench.drive.commanded_mode, 9);
}

TEST(SwitchingTheMode, EndsWhatTheModeBeforeHeldInAnRpdo) {
  DriveProfile profile = testProfile();
  NamedWrite speed;
  speed.object = "target_velocity";
  speed.value = 0.7;
  profile.modes[4].entry_writes = {speed};  // the speed limit of a position mode
  Bench bench(testConfig(std::move(profile)));
  ASSERT_TRUE(bench.boot() && bench.enable());
  ASSERT_EQ(bench.drive.target_velocity, 7000);
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csv").success);
  EXPECT_EQ(bench.drive.target_velocity, 0);
  bench.follow(0.5);
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.drive.target_velocity, 5000);
}

TEST(SwitchingTheMode, IsForgottenWithTheNode) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csv").success);
  bench.reboot();
  EXPECT_EQ(bench.axis.modeName(), "cyclic_position");
}

// --- Set-points that are called back -------------------------------------------------------------

TEST(CalledBack, AStreamBeforeAMotorThatStands) {
  HeldAxis axis;
  double target = axis.axis.target();
  axis.each_cycle = [&] {
    if (axis.axis.noticeCount() == 0) static_cast<void>(axis.axis.setTarget(target += 0.001));
  };
  ASSERT_TRUE(axis.runUntil([&] { return axis.axis.noticeCount() != 0; }, milliseconds(400)));
  EXPECT_THAT(axis.axis.notice(), HasSubstr("the motor stands while its set-points run, 0.0"));
  EXPECT_THAT(axis.axis.notice(), HasSubstr(" rad ahead: the brake, a limit or the load holds it"));
  EXPECT_THAT(axis.axis.notice(), HasSubstr("called back to where it stands"));
  EXPECT_EQ(axis.axis.setPoint().givenUp(), 1u);
  axis.run(milliseconds(12));
  EXPECT_EQ(axis.sent(), 12345);
}

TEST(CalledBack, AVelocityOfAMotorThatALimitHolds) {
  for (const bool prismatic : {false, true}) {
    DriveProfile profile = testProfile();
    profile.modes.push_back(
        test::modeSpec("velocity", 2, ControlKind::velocity, false, "target_velocity"));
    AxisConfig config = withMode("velocity", std::move(profile));
    if (prismatic) {
      config.geometry.type = AxisGeometry::Type::prismatic;
      config.geometry.lead = 1.0;
      config.standstill_velocity = 0.002;
    }
    Bench bench(config);
    ASSERT_TRUE(bench.boot() && bench.enable());
    bench.drive.at_limit = true;
    bench.each_cycle = [&] {
      if (bench.axis.noticeCount() == 0) static_cast<void>(bench.axis.setTarget(0.5));
    };
    ASSERT_TRUE(bench.runUntil([&] { return bench.axis.noticeCount() != 0; }, milliseconds(400)));
    EXPECT_THAT(bench.axis.notice(), HasSubstr(prismatic ? "it is to turn at 0.500 m/s"
                                                         : "it is to turn at 0.500 rad/s"));
    EXPECT_THAT(bench.axis.notice(), HasSubstr("internal limit active (statusword bit 11)"));
    EXPECT_THAT(bench.axis.notice(), HasSubstr("The velocity is set to 0"));
    EXPECT_EQ(bench.axis.setPoint().givenUp(), 1u);
    bench.run(milliseconds(12));
    EXPECT_EQ(bench.drive.target_velocity, 0);
  }
}

// 0.0001 rad a count; beyond 2147483647 the numbers of 32 bits go on at -2147483648.
TEST(ContinuousJoint, ItsTargetsWrapAsItsPositionsDo) {
  AxisConfig config = withMode("interpolated_position");
  config.geometry.type = AxisGeometry::Type::continuous;
  config.limits.lower.reset();
  config.limits.upper.reset();
  HeldAxis axis(config, 2147483000);
  axis.lead(214748.3 + 0.07);  // 700 counts on
  EXPECT_NEAR(axis.sent(), -2147483648 + 52, 1);
}

TEST(HaltedStream, ReleasedItHoldsWhereItsSetPointsCameToRest) {
  HeldAxis axis;
  axis.lead(1.2445);
  ASSERT_TRUE(axis.perform(ProcedureKind::halt).success);
  ASSERT_TRUE(axis.perform(ProcedureKind::enable).success);
  EXPECT_EQ(axis.axis.state().halted, false);
  axis.run(milliseconds(40));
  EXPECT_EQ(axis.sent(), 12445) << "a target that jumps to the motor would let its load sag";
}

}  // namespace
}  // namespace cia402::drive
