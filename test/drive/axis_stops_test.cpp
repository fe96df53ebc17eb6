// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the axis does by itself to come to rest, and what is taken for rest.
#include <algorithm>
#include <cmath>

#include "drive/axis/standstill.h"
#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;

/// The drive plans its motion, and has no halt bit.
AxisConfig planned() {
  DriveProfile profile = testProfile();
  profile.halt_supported = false;
  AxisConfig config = testConfig(std::move(profile));
  config.mode = "profile_position";
  return config;
}

// --- Stops that nobody asked for -----------------------------------------------------------------

std::size_t quickStopsBySdo(const FakeDrive& drive) {
  return static_cast<std::size_t>(std::count(drive.writes.begin(), drive.writes.end(),
                                             std::pair<unsigned, std::uint64_t>(0x6040, 0x0002)));
}

TEST(StopBySdo, QuickStopsAnEnabledAxisAndSaysWhy) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.axis.stopBesideCycle("SYNC is gone");
  EXPECT_EQ(bench.axis.noticeCount(), 1u);
  EXPECT_EQ(bench.axis.notice(), "shoulder (node 3): SYNC is gone");
  EXPECT_EQ(bench.axis.notice(bench.axis.noticeCount()).kind, NoticeKind::error);
  bench.run(milliseconds(12));
  EXPECT_EQ(quickStopsBySdo(bench.drive), 1u);
  EXPECT_EQ(bench.drive.controlword, 0x0002) << "no RPDO that arrives enables it again";
  EXPECT_FALSE(bench.axis.state().ready_for_motion);
  bench.run(milliseconds(300));
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
  EXPECT_EQ(bench.axis.noticeCount(), 1u);
}

TEST(StopBySdo, LeavesAnAxisWithoutPowerAlone) {
  Bench bench;
  bench.axis.stopBesideCycle("SYNC is gone");
  ASSERT_TRUE(bench.boot());
  bench.axis.stopBesideCycle("SYNC is gone");
  bench.run(milliseconds(40));
  EXPECT_EQ(quickStopsBySdo(bench.drive), 0u);
  EXPECT_EQ(bench.axis.noticeCount(), 0u);
  EXPECT_EQ(bench.drive.controlword, 0x0000);
}

TEST(StopBySdo, StopsADriveThatSomebodyElseEnabledWithoutAWord) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.state = FakeDrive::S::enabled;
  bench.drive.stuck.insert(FakeDrive::S::enabled);
  bench.run(milliseconds(40));
  bench.axis.stopBesideCycle("SYNC is gone");
  bench.run(milliseconds(12));
  EXPECT_EQ(quickStopsBySdo(bench.drive), 1u);
  EXPECT_EQ(bench.axis.noticeCount(), 0u) << "it was not commanded";
}

TEST(StopBySdo, IsNotToldOfAnAxisThatWasSwitchedOff) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  bench.drive.state = FakeDrive::S::enabled;  // by somebody else
  bench.drive.stuck.insert(FakeDrive::S::enabled);
  bench.run(milliseconds(40));
  bench.axis.stopBesideCycle("SYNC is gone");
  bench.run(milliseconds(12));
  EXPECT_EQ(quickStopsBySdo(bench.drive), 1u);
  EXPECT_EQ(bench.axis.noticeCount(), 0u);
}

TEST(StopBySdo, ThatTheDriveRefusesIsTold) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.drive.aborts[{0x6040, 0}] = 0x08000022;
  bench.axis.stopBesideCycle("SYNC is gone");
  bench.run(milliseconds(12));
  EXPECT_EQ(bench.axis.noticeCount(), 2u);
  EXPECT_THAT(bench.axis.notice(), HasSubstr("the quick stop by SDO failed"));
  EXPECT_THAT(bench.axis.notice(), HasSubstr("08000022"));
  EXPECT_THAT(bench.axis.notice(), HasSubstr("switch its power off"));
}

TEST(BusLoss, QuickStopsAnEnabledAxisAndSaysWhy) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.axis.onBusLost("can0 is bus-off");
  EXPECT_EQ(bench.axis.noticeCount(), 1u);
  EXPECT_THAT(bench.axis.notice(),
              HasSubstr("shoulder (node 3): can0 is bus-off: nothing reaches"));
  bench.run(milliseconds(12));
  EXPECT_EQ(bench.drive.controlword, 0x0002);
  bench.axis.onBusLost("can0 is bus-off");
  EXPECT_EQ(bench.axis.noticeCount(), 1u);
}

TEST(BusLoss, LeavesADisabledAxisAlone) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  bench.axis.onBusLost("can0 is bus-off");
  bench.run(milliseconds(12));
  EXPECT_EQ(bench.axis.noticeCount(), 0u);
  EXPECT_EQ(bench.drive.controlword, 0x0000);
}

// Disable operation, 0007h, would wait for a drive that does not listen to the state commands.
TEST(SwitchingOff, OfAnAxisThatNoQuickStopBrakesIsDisableVoltageWhateverTheDriveShows) {
  AxisConfig config = testConfig();
  config.mode = "cyclic_velocity";
  Bench bench(config);
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.drive.coast = 3000;
  bench.drive.stuck.insert(FakeDrive::S::enabled);
  bench.drive.controlwords.clear();
  EXPECT_FALSE(bench.perform(ProcedureKind::disable).success);
  EXPECT_EQ(bench.drive.controlwords, (std::vector<std::uint16_t>{0x0002, 0x0000}));
}

// Two periods after the last set-point a cycle is in time.
TEST(LateCycle, InterruptsAStream) {
  for (const bool late : {false, true}) {
    Bench bench;
    ASSERT_TRUE(bench.boot() && bench.enable());
    bench.follow(3.0);
    bench.run(milliseconds(40));
    ASSERT_NE(bench.axis.setPoint().velocity(), 0.0);
    bench.now += milliseconds(late ? 5 : 4);
    bench.cycle();
    EXPECT_EQ(bench.axis.setPoint().interruptions(), late ? 1u : 0u);
  }
}

// --- Halts where the drive plans -----------------------------------------------------------------

/// On its way to a limit at 2 rad/s, which takes 0.25 rad to stop from.
struct TravellingAxis : Bench {
  explicit TravellingAxis(double until = 1.6) : Bench(planned()) {
    EXPECT_TRUE(boot() && enable());
    const bool up = until > axis.state().position;
    EXPECT_TRUE(axis.setTarget(up ? 3.1 : -3.1));
    EXPECT_TRUE(runUntil([&] { return (axis.state().position > until) == up; }));
  }
  void halt() { EXPECT_TRUE(axis.start({ProcedureKind::halt, {}, 0.0}, now).ok()); }
  bool halted() {
    return runUntil([&] { return !axis.procedure().running; }) && axis.procedure().success;
  }
  /// The program sleeps meanwhile.
  void pass(Duration time, double counts_per_second) {
    now += time;
    drive.position += counts_per_second * toSeconds(time);
  }
};

TEST(StopPoint, StaysWithinTheLimits) {
  for (const double side : {1.0, -1.0}) {
    TravellingAxis axis(2.9 * side);  // cannot stop before 3.15
    axis.halt();
    ASSERT_TRUE(axis.halted());
    EXPECT_EQ(axis.drive.accepted_target, 31000 * side);
  }
}

TEST(StopPoint, CountsFromWhereTheAxisIsByNowWhereItsFeedbackIsOld) {
  TravellingAxis axis;
  axis.drive.silent = true;
  axis.run(milliseconds(28));
  axis.halt();
  axis.cycle();
  const double from = axis.drive.position;
  ASSERT_TRUE(axis.runUntil([&] { return axis.drive.accepted_target != 31000; }));
  EXPECT_GE(axis.drive.accepted_target, from + 2500);
}

TEST(StopPoint, IsNotMovedByASecondHalt) {
  TravellingAxis axis;
  axis.halt();
  axis.run(milliseconds(60));
  const std::int32_t point = axis.drive.accepted_target;
  axis.halt();
  ASSERT_TRUE(axis.halted());
  EXPECT_EQ(axis.drive.accepted_target, point);
}

TEST(StopPoint, StaysAfterALateCycleWhereItIsFarEnoughStill) {
  TravellingAxis axis;
  axis.halt();
  axis.cycle();
  axis.pass(milliseconds(6), 20000);
  const double point = axis.axis.target();
  ASSERT_TRUE(axis.halted());
  EXPECT_EQ(axis.axis.target(), point);
}

// The drive may have got the point so late that it lies too near, or behind it.
TEST(StopPoint, IsGivenAnewAfterALateCycleByFeedbackThatIsNewer) {
  TravellingAxis axis;
  axis.halt();
  axis.run(milliseconds(8));
  axis.pass(milliseconds(75), 20000);
  axis.drive.silent = true;
  axis.cycle();  // knows only where the axis was before
  axis.drive.silent = false;
  axis.cycle();
  const double from = axis.axis.state().position;
  ASSERT_TRUE(axis.halted());
  EXPECT_GE(axis.axis.state().position - from, 0.25);
}

TEST(StopPoint, OfAnAxisThatStandsIsNotGivenAnewAfterALateCycle) {
  TravellingAxis axis;
  axis.halt();
  ASSERT_TRUE(axis.halted());
  axis.drive.at_limit = true;  // held a little beyond it
  axis.drive.position += 50;
  axis.run(milliseconds(200));
  const std::size_t told = axis.drive.accepted.size();
  axis.pass(milliseconds(75), 0);
  axis.run(milliseconds(100));
  EXPECT_EQ(axis.drive.accepted.size(), told);
  EXPECT_TRUE(axis.axis.state().halted);
}

TEST(StopPoint, ThatABusLossComesBeforeIsNotGivenToTheEnabledAxisLater) {
  TravellingAxis axis;
  axis.halt();
  axis.each_cycle = [&] { axis.axis.onBusLost("can0 is bus-off"); };
  axis.cycle();  // halted, and lost before anything was sent
  axis.each_cycle = nullptr;
  ASSERT_TRUE(axis.runUntil([&] { return axis.drive.state == FakeDrive::S::disabled; }));
  axis.run(milliseconds(200));
  axis.drive.accepted.clear();
  ASSERT_TRUE(axis.enable());
  axis.run(milliseconds(100));
  EXPECT_TRUE(axis.drive.accepted.empty());
}

/// How long a halted axis that stands so many counts beyond its stop point may still move.
Duration mayMoveAtStopPoint(double beyond) {
  TravellingAxis axis;
  axis.halt();
  EXPECT_TRUE(axis.runUntil([&] {
    return axis.drive.accepted_target != 31000 &&
           std::fabs(axis.drive.position - axis.drive.accepted_target) < 1.0;
  }));
  axis.drive.at_limit = true;
  axis.drive.position += beyond;
  axis.cycle();
  const Time stands = axis.now;
  EXPECT_TRUE(axis.axis.mayMove());
  EXPECT_TRUE(axis.runUntil([&] { return !axis.axis.mayMove(); }));
  return axis.now - stands;
}

// Two windows of 50 ms show that it stands, and it has to be seen in one that begins after that.
TEST(StopPoint, WhereADriveStandsBeyondItItMayBeTurningBack) {
  const Duration at = mayMoveAtStopPoint(0), beyond = mayMoveAtStopPoint(30);
  EXPECT_LE(at, 2 * Standstill::kWindow + 4 * Bench::kCycle);
  EXPECT_GE(beyond, at + Standstill::kWindow);
  EXPECT_LE(beyond, milliseconds(300));
}

// --- Bits of the mode ----------------------------------------------------------------------------

TEST(ModeBits, AreHeldInOperationOnly) {
  DriveProfile profile = testProfile();
  profile.modes[4].controlword_bits = 0x1000;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.cycle();
  EXPECT_EQ(bench.drive.controlwords,
            (std::vector<std::uint16_t>{0x0000, 0x0006, 0x0007, 0x000F, 0x100F}));
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csv").success);
  EXPECT_EQ(bench.drive.controlword, 0x000F);
}

/// A drive that may show by statusword bit 12 that it follows its set-points, and its mode once it
/// is enabled.
struct FollowingDrive : Bench {
  bool bit_12 = false;
  Duration mode_after{0};  ///< of operation enabled
  Time enabled = kNever;

  FollowingDrive() : Bench(config()) {
    EXPECT_TRUE(boot());
    drive.silent = true;  // the test sends for it
    each_cycle = [this] {
      if (drive.state != FakeDrive::S::enabled)
        enabled = kNever;
      else if (enabled == kNever)
        enabled = now;
      const bool shown = enabled != kNever && now - enabled >= mode_after;
      const auto word = static_cast<std::uint16_t>(drive.statusword() | (bit_12 ? 0x1000 : 0));
      bring({{{0x6041, 0}, word}, {{0x6064, 0}, 12345}, {{0x6061, 0}, shown ? 8u : 0u}});
    };
  }
  static AxisConfig config() {
    DriveProfile profile = testProfile();
    profile.modes[4].follows_command_bit = 12;
    profile.mode_change.shown_when_enabled = true;
    return testConfig(std::move(profile));
  }
  /// From operation enabled until the axis takes commands.
  Duration untilReady() {
    EXPECT_TRUE(enable());
    EXPECT_TRUE(runUntil([&] { return axis.state().ready_for_motion; }));
    return now - enabled;
  }
  void disable() { EXPECT_TRUE(perform(ProcedureKind::disable).success); }
};

TEST(ModeBits, ADriveThatShowsThatItFollowsIsWaitedForNoLonger) {
  FollowingDrive drive;
  drive.bit_12 = true;
  EXPECT_LE(drive.untilReady(), milliseconds(100));
}

TEST(ModeBits, ADriveThatNeverShowsThatItFollowsIsWaitedForOnce) {
  FollowingDrive drive;
  EXPECT_GE(drive.untilReady(), milliseconds(1000));
  drive.disable();
  EXPECT_LE(drive.untilReady(), milliseconds(100));
}

// The axis may have sagged while the brake opened; and the cycle in which that is over may be late.
TEST(ModeBits, BeginWhereTheMotorIsOnceTheBrakeIsReleased) {
  for (const Duration late : {milliseconds(0), milliseconds(24)}) {
    SCOPED_TRACE(late.count());
    DriveProfile profile = testProfile();
    profile.timing.brake_release = milliseconds(200);
    profile.modes[4].controlword_bits = 0x0010;
    Bench bench(testConfig(profile));
    ASSERT_TRUE(bench.boot());
    ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0}, bench.now).ok());
    ASSERT_TRUE(bench.runUntil([&] { return bench.drive.state == FakeDrive::S::enabled; }));
    bench.run(milliseconds(188));
    ASSERT_EQ(bench.drive.controlword, 0x000F);
    ASSERT_EQ(bench.drive.target_position, 12345);
    bench.drive.silent = true;  // the test sends for it
    bench.each_cycle = [&bench] {
      bench.bring(
          {{{0x6041, 0}, bench.drive.statusword()}, {{0x6064, 0}, 11845}, {{0x6061, 0}, 8}});
    };
    bench.cycle();
    bench.now += late;
    ASSERT_TRUE(bench.runUntil([&] { return bench.drive.controlword == 0x001F; }));
    EXPECT_EQ(bench.drive.target_position, 11845);
  }
}

TEST(ModeBits, ADriveThatWasLateInItsModeMayHaveTheBit) {
  FollowingDrive drive;
  drive.mode_after = milliseconds(200);
  EXPECT_GE(drive.untilReady(), milliseconds(1000));
  drive.disable();
  drive.mode_after = milliseconds(0);
  EXPECT_GE(drive.untilReady(), milliseconds(1000));
  drive.disable();
  EXPECT_LE(drive.untilReady(), milliseconds(100));
}

// --- Warnings ------------------------------------------------------------------------------------

}  // namespace
}  // namespace cia402::drive
