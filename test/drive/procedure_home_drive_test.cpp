// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Homing by the drive: old results, interruptions, the way back.
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
using S = FakeDrive::S;
using namespace std::chrono_literals;

constexpr std::pair<unsigned, unsigned> kHighest{0x607D, 2};

AxisConfig searches(DriveProfile profile = testProfile()) {
  AxisConfig config = testConfig(std::move(profile));
  config.homing = HomingOptions();
  config.homing->method = 17;
  config.homing->search_velocity = 0.3;
  config.homing->offset = 1.0;
  config.homing->timeout = 3s;
  return config;
}

DriveProfile withLimits() {
  DriveProfile profile = testProfile();
  profile.objects.push_back(test::object("lower", 0x607D, DataType::int32, Quantity::position, 1));
  profile.objects.push_back(test::object("upper", 0x607D, DataType::int32, Quantity::position, 2));
  profile.startup = {test::from("lower", "limits.lower"), test::from("upper", "limits.upper")};
  for (NamedWrite& write : profile.startup) write.when_homed = write.optional = true;
  return profile;
}

DriveProfile withoutOldResult() {
  DriveProfile profile = testProfile();
  profile.homing.needs_zero_attained_before_start = true;
  return profile;
}

TEST(DriveHoming, TellsWhatItWaitsFor) {
  Bench bench(searches());
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(100ms);
  EXPECT_EQ(
      stepsOf(bench, ProcedureKind::home),
      (std::vector<std::string>{
          "starting | ", "writing parameters | the drive to take homing_method (6098:00)",
          "writing parameters | the drive to take homing_search_velocity (6099:01)",
          "setting the target to the actual value | its RPDO to be sent",
          "switching the mode | 6061:00 to show 6 (homing)",
          "writing parameters | the drive to take home_offset (607C:00)",
          "preparing the start | the result of an earlier homing to be cleared",
          "searching home | homing attained (statusword bit 12), method 17 (negative limit switch)",
          "home found | standstill",
          "writing position limits | the drive to take those of the new zero",
          "setting the target to the actual value | its RPDO to be sent",
          "switching the mode | 6061:00 to show 8 (cyclic_position)"}));
}

// 6099h as the drive has it: 1 count/s is 0.0001 rad/s, the joint's limit 2 rad/s.
class HomingAtTheDrivesOwnSpeed : public testing::Test {
 protected:
  static AxisConfig configured(bool limited = true) {
    AxisConfig config = searches();
    config.homing->search_velocity = 0.0;
    if (!limited) config.limits.velocity.reset();
    return config;
  }
  static constexpr FakeDrive::Key kSearchSpeed{0x6099, 1};
};

TEST_F(HomingAtTheDrivesOwnSpeed, IsRefusedBeyondTheLimit) {
  Bench bench(configured());
  bench.drive.dictionary[kSearchSpeed] = {20100, 4};
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_FALSE(status.success);
  EXPECT_EQ(status.message,
            "shoulder (node 3): is not homed, as the drive would search with a "
            "homing_search_velocity (6099:01) of 2.01 rad/s, beyond the joint's limit 2 rad/s; "
            "give `search_velocity` in `homing` of axes/shoulder");
  EXPECT_EQ(bench.drive.homings, 0);
}

TEST_F(HomingAtTheDrivesOwnSpeed, IsTakenUpToTheLimit) {
  Bench bench(configured());
  bench.drive.dictionary[kSearchSpeed] = {20000, 4};
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_TRUE(status.success) << status.message;
}

TEST_F(HomingAtTheDrivesOwnSpeed, IsTakenWhereTheDriveDoesNotTellIt) {
  for (const bool answers : {true, false}) {
    Bench bench(configured());
    if (answers) {
      bench.drive.read_aborts[kSearchSpeed] = 0x06020000;
    } else {
      bench.drive.unanswered_reads.insert(kSearchSpeed);
    }
    ASSERT_TRUE(bench.boot());
    const ProcedureStatus& status = bench.perform(ProcedureKind::home);
    EXPECT_TRUE(status.success) << status.message;
  }
}

TEST_F(HomingAtTheDrivesOwnSpeed, IsNotAskedForWithoutALimit) {
  Bench bench(configured(false));
  bench.drive.dictionary[kSearchSpeed] = {20100, 4};
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  EXPECT_EQ(bench.drive.reads[kSearchSpeed], 0);
}

TEST(DriveHoming, StartsAtOnceWhereNoOldResultIsShown) {
  Bench bench(searches(withoutOldResult()));
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_EQ(bench.drive.homings, 1);
}

TEST(DriveHoming, DoesNotStartOverAnOldResultThatADriveWouldTakeForTheNewOne) {
  Bench bench(searches(withoutOldResult()));
  bench.drive.keeps_attained = true;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.perform(ProcedureKind::home).success);
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_FALSE(status.success);
  EXPECT_EQ(bench.drive.homings, 1);
  EXPECT_THAT(status.message, HasSubstr("the drive still shows the result of an earlier homing"));
  EXPECT_EQ(bench.axis.modeName(), "cyclic_position");
}

TEST(DriveHoming, ASearchThatIsOverAtOnceIsASuccess) {
  Bench bench(searches());
  bench.drive.homing_cycles = 0;
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_TRUE(status.success) << status.message;
}

TEST(DriveHoming, ASearchThatTheDriveInterruptsIsGivenUp) {
  Bench bench(searches());
  bench.drive.never_homes = true;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::home, {}, 0.0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.velocity < 0; }));
  bench.run(100ms);
  bench.drive.mode = 1;  // for a moment; when it is back in its homing mode it searches no more
  const Time interrupted = bench.now;
  ASSERT_TRUE(bench.runUntil([&] { return bench.axis.procedure().step == "stopping"; }));
  EXPECT_GT(bench.now - interrupted, 500ms) << "it may go on";
  EXPECT_LT(bench.now - interrupted, 700ms);
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("homing stopped: the drive interrupted it (statusword 0x"));
  EXPECT_FALSE(bench.axis.state().homed);
}

TEST(DriveHoming, IsStoppedByTheHaltBitWhereTheDriveHasOne) {
  for (const bool has_halt : {true, false}) {
    SCOPED_TRACE(has_halt);
    DriveProfile profile = testProfile();
    profile.halt_supported = has_halt;
    Bench bench(searches(profile));
    bench.drive.never_homes = true;
    ASSERT_TRUE(bench.boot());
    ASSERT_TRUE(bench.axis.start({ProcedureKind::home, {}, 0.0}, bench.now).ok());
    ASSERT_TRUE(bench.runUntil([&] { return bench.drive.velocity < 0; }));
    bench.axis.cancel("the action was cancelled", bench.now);
    bench.run(12ms);
    EXPECT_EQ(bench.drive.controlword & 0x0110, has_halt ? 0x0100 : 0) << "bit 4 is low";
    ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
    bench.run(12ms);
    EXPECT_EQ(bench.drive.controlword, 0x000F);
  }
}

// A drive that has found home when it is halted goes back to it, once nothing but its mode holds
// it.
TEST(DriveHoming, IsReleasedFromItsHaltWithTheModeOrAwaitedAtRestBefore) {
  for (const bool while_halted : {true, false}) {
    SCOPED_TRACE(while_halted);
    DriveProfile profile = testProfile();
    profile.mode_change.while_halted = while_halted;
    Bench bench(searches(profile));
    bench.drive.never_homes = true;
    ASSERT_TRUE(bench.boot());
    ASSERT_TRUE(bench.axis.start({ProcedureKind::home, {}, 0.0}, bench.now).ok());
    ASSERT_TRUE(bench.runUntil([&] { return bench.drive.velocity < 0; }));
    bench.axis.cancel("the action was cancelled", bench.now);
    ASSERT_TRUE(bench.runUntil([&] { return (bench.drive.controlword & 0x0100) != 0; }));
    int goes_back = 0;
    bench.each_cycle = [&] {
      const bool released = bench.drive.mode == 6 && (bench.drive.controlword & 0x0110) == 0;
      bench.drive.coast = released && goes_back++ < 25 ? 500 : 0;
    };
    ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
    EXPECT_EQ(bench.drive.velocity, 0.0);
    EXPECT_EQ(goes_back == 0, while_halted);
    EXPECT_EQ(goes_back > 25, !while_halted);
    EXPECT_THAT(bench.axis.procedure().message, HasSubstr("; the axis stands at "));
    bench.run(12ms);
    EXPECT_EQ(bench.drive.controlword, 0x000F);
    EXPECT_EQ(bench.drive.mode, 8);
  }
}

TEST(DriveHoming, AnAxisThatIsStoppedGetsItsTimeToComeToRest) {
  for (const auto coasting : {1500ms, 3000ms}) {
    SCOPED_TRACE(coasting.count());
    Bench bench(searches());
    bench.drive.never_homes = true;
    ASSERT_TRUE(bench.boot());
    bench.run(3s);
    ASSERT_TRUE(bench.axis.start({ProcedureKind::home, {}, 0.0}, bench.now).ok());
    ASSERT_TRUE(bench.runUntil([&] { return bench.drive.velocity < 0; }));
    const Time cancelled = bench.now;
    bench.each_cycle = [&] { bench.drive.coast = bench.now - cancelled < coasting ? -500 : 0; };
    bench.axis.cancel("the action was cancelled", bench.now);
    ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
    EXPECT_FALSE(bench.axis.procedure().success);
    EXPECT_EQ(bench.axis.modeName(), "cyclic_position");
    if (coasting < 2s) {
      EXPECT_THAT(bench.axis.procedure().message, HasSubstr("; the axis stands at "));
    } else {
      EXPECT_GE(bench.now - cancelled, 2s);
      EXPECT_THAT(bench.axis.procedure().message,
                  HasSubstr("the axis did not come to rest, quick stop is commanded"));
      bench.run(12ms);
      EXPECT_EQ(bench.drive.controlword, 0x0002);
    }
  }
}

TEST(DriveHoming, WritesLimitsOnceTheAxisStandsAtHome) {
  Bench bench(searches(withLimits()));
  bench.drive.dictionary[{0x607D, 1}] = bench.drive.dictionary[kHighest] = {0, 4};
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  Time found{};
  bool closed_in_motion = false;
  bench.each_cycle = [&] {
    if (found == Time{} && bench.axis.procedure().step == "home found") found = bench.now;
    bench.drive.coast = found != Time{} && bench.now - found < 400ms ? 500 : 0;
    closed_in_motion |= bench.drive.coast != 0 && bench.drive.dictionary[kHighest].first == 31000;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_FALSE(closed_in_motion);
  EXPECT_EQ(bench.drive.dictionary[kHighest].first, 31000u);
}

TEST(DriveHoming, StaysInItsModeUntilTheDriveHasTheLimits) {
  Bench bench(searches(withLimits()));
  bench.drive.dictionary[{0x607D, 1}] = bench.drive.dictionary[kHighest] = {0, 4};
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_EQ(bench.drive.commanded_mode, 8);
  Time asked{};
  bench.each_cycle = [&] {
    if (asked == Time{} && bench.axis.procedure().step == "home found") {
      asked = bench.now;
      bench.drive.unanswered.insert(kHighest);  // for the first time only
    }
    if (asked != Time{} && bench.now - asked > 300ms) {
      bench.drive.unanswered.clear();
    } else if (asked != Time{}) {
      EXPECT_EQ(bench.drive.commanded_mode, 6);
    }
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_GT(bench.now - asked, 500ms) << "timing/sdo";
  EXPECT_EQ(bench.drive.commanded_mode, 8);
}

TEST(DriveHoming, GivenUpByItsDeadlineItLeavesTheHomingMode) {
  Bench bench(searches());
  bench.drive.never_homes = true;
  ASSERT_TRUE(bench.boot());
  bench.run(100ms);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::home, {}, 0.0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.mode == 6; }));
  bench.drive.shows = {S::disabled, S::ready};  // it bounces
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }, 120s));
  EXPECT_THAT(bench.axis.procedure().message, HasSubstr("home was given up after "));
  EXPECT_EQ(bench.axis.modeName(), "cyclic_position");
}

}  // namespace
}  // namespace cia402::drive
