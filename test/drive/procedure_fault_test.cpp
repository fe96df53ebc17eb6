// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// clear_faults and recover.
#include <algorithm>

#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;

void fault(Bench& bench, std::uint16_t code = 0x8611) {
  bench.fail(code);
  bench.run(milliseconds(40));
}

TEST(ClearFaultsProcedure, MakesOneEdgeAndLeavesTheAxisDisabled) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  fault(bench);
  bench.drive.controlwords.clear();
  const ProcedureStatus& status = bench.perform(ProcedureKind::clear_faults);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_EQ(bench.drive.controlwords, (std::vector<std::uint16_t>{0x0080, 0x0000}));
  EXPECT_EQ(bench.drive.resets, 1);
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
  EXPECT_THAT(status.message, HasSubstr("shoulder: fault 0x8611 following error"));
  EXPECT_THAT(status.message, HasSubstr("it is cleared; the axis is disabled"));
  EXPECT_EQ(bench.axis.faultText(), "");
  EXPECT_EQ(bench.axis.state().error_code, 0);
}

TEST(ClearFaultsProcedure, WaitsForTheFaultReactionToEnd) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.fail(0x8611);
  bench.cycle();
  EXPECT_EQ(bench.drive.state, FakeDrive::S::reaction);
  EXPECT_TRUE(bench.perform(ProcedureKind::clear_faults).success);
  EXPECT_EQ(bench.drive.resets, 1);
}

/// A family that says how the fault 0x8611 ends.
AxisConfig withReset(ErrorText::Reset reset, Duration wait) {
  DriveProfile profile = testProfile();
  ErrorText& error = profile.errors[0x8611] = ErrorText();
  error.text = "position error";
  error.reset = reset;
  error.wait = wait;
  return testConfig(std::move(profile));
}

TEST(ClearFaultsProcedure, TriesNoResetOfWhatOnlyPowerClears) {
  Bench bench(withReset(ErrorText::Reset::power_cycle, Duration(0)));
  ASSERT_TRUE(bench.boot());
  fault(bench);
  bench.drive.controlwords.clear();
  for (const ProcedureKind kind : {ProcedureKind::clear_faults, ProcedureKind::recover}) {
    const ProcedureStatus& status = bench.perform(kind);
    EXPECT_FALSE(status.success);
    EXPECT_THAT(status.message,
                HasSubstr("fault 0x8611 position error; then switch the drive's power off and on: "
                          "nothing else clears it"));
  }
  for (const std::uint16_t word : bench.drive.controlwords) EXPECT_EQ(word & 0x0080, 0);
  EXPECT_EQ(bench.drive.state, FakeDrive::S::fault);
  EXPECT_THAT(bench.axis.faultText(), HasSubstr("nothing else clears it"));
}

TEST(ClearFaultsProcedure, TellsHowLongTheDriveTakesNoReset) {
  Bench bench(withReset(ErrorText::Reset::by_bit, std::chrono::seconds(5)));
  ASSERT_TRUE(bench.boot());
  for (const int faults : {1, 2}) {  // each waits anew
    fault(bench);
    bench.run(milliseconds(1000));
    const ProcedureStatus& early = bench.perform(ProcedureKind::clear_faults);
    EXPECT_FALSE(early.success);
    EXPECT_THAT(early.message,
                HasSubstr("the drive takes no reset of it for 5 s: call again in 4 s"));
    EXPECT_EQ(bench.drive.resets, faults - 1);
    bench.run(milliseconds(4000));
    EXPECT_TRUE(bench.perform(ProcedureKind::clear_faults).success);
    EXPECT_EQ(bench.drive.resets, faults);
  }
}

TEST(ClearFaultsProcedure, SaysOfAFaultThatItEndsByItself) {
  Bench bench(withReset(ErrorText::Reset::by_itself, Duration(0)));
  ASSERT_TRUE(bench.boot());
  fault(bench);
  EXPECT_THAT(bench.axis.faultText(),
              HasSubstr("position error; it ends by itself once its cause is gone, then enable"));
  EXPECT_TRUE(bench.perform(ProcedureKind::clear_faults).success) << "trying does no harm";
}

TEST(ClearFaultsProcedure, WithoutAFaultHasNothingToClear) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  const ProcedureStatus& status = bench.perform(ProcedureKind::clear_faults);
  EXPECT_TRUE(status.success);
  EXPECT_EQ(status.message, "shoulder: no fault, nothing to clear");
  EXPECT_EQ(bench.drive.controlword, 0x000F);
}

TEST(ClearFaultsProcedure, OfADriveThatIsSilentWaitsForWhatItSaysNext) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.silent = true;
  bench.run(milliseconds(40));
  ASSERT_TRUE(bench.axis.state().feedback_valid) << "not yet stale";
  bench.drive.fail(0x8611);  // nobody hears of it
  ASSERT_TRUE(bench.axis.start({ProcedureKind::clear_faults, "", 0.0}, bench.now));
  bench.run(milliseconds(30));
  EXPECT_TRUE(bench.axis.procedure().running) << bench.axis.procedure().message;
  bench.drive.silent = false;
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
  EXPECT_EQ(bench.drive.resets, 1);
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
}

TEST(ClearFaultsProcedure, OfADriveThatStaysSilentDoesNotSayThatThereIsNoFault) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.silent = true;
  bench.run(milliseconds(40));
  const ProcedureStatus& status = bench.perform(ProcedureKind::clear_faults);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("nothing tells whether it has a fault: "));
}

TEST(ClearFaultsProcedure, OfADriveThatFallsSilentDoesNotSayThatItIsCleared) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  fault(bench);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::clear_faults, "", 0.0}, bench.now));
  bench.drive.silent = true;
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_FALSE(bench.axis.procedure().success);
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("nothing tells whether the fault reset has cleared its fault: "));
}

TEST(ClearFaultsProcedure, AFaultThatComesBackIsToldWithCauseAndRemedy) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  fault(bench);
  bench.drive.fault_persists = true;
  const ProcedureStatus& status = bench.perform(ProcedureKind::clear_faults);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("shoulder (node 3): fault 0x8611 following error"));
  EXPECT_THAT(status.message, HasSubstr("came back at once"));
  EXPECT_THAT(status.message, HasSubstr("check the mechanics and 6065:00"));
}

TEST(ClearFaultsProcedure, AFaultThatStaysTimesOutWithBitSevenLowAgain) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  fault(bench);
  bench.drive.stuck.insert(FakeDrive::S::fault);
  const ProcedureStatus& status = bench.perform(ProcedureKind::clear_faults);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message,
              HasSubstr("the fault reset (6040:00 bit 7) did not clear it within 2"));
  bench.run(milliseconds(8));
  EXPECT_EQ(bench.drive.controlword, 0x0000);
}

TEST(ClearFaultsProcedure, EdgesAreAtLeastASecondApart) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  fault(bench);
  std::vector<Time> edges;
  bench.each_cycle = [&, last = 0]() mutable {
    if (bench.drive.resets != last) edges.push_back(bench.now);
    last = bench.drive.resets;
  };
  bench.drive.fault_persists = true;
  for (int i = 0; i < 3; ++i) {
    bench.perform(ProcedureKind::clear_faults);
    bench.run(milliseconds(60));
  }
  ASSERT_EQ(edges.size(), 3u);
  EXPECT_GE(edges[1] - edges[0], std::chrono::seconds(1));
  EXPECT_GE(edges[2] - edges[1], std::chrono::seconds(1));
}

TEST(ClearFaultsProcedure, AWarningIsClearedWhereItStopsTheDrive) {
  DriveProfile profile = testProfile();
  profile.warning_stops = true;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.warning = true;
  bench.run(milliseconds(20));
  bench.each_cycle = [&] {
    if ((bench.drive.controlword & 0x80) != 0) bench.drive.warning = false;
  };
  EXPECT_TRUE(bench.perform(ProcedureKind::clear_faults).success);
  EXPECT_FALSE(bench.drive.warning);
}

TEST(RecoverProcedure, ClearsTheFaultAndEnables) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  fault(bench);
  const ProcedureStatus& status = bench.perform(ProcedureKind::recover);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_THAT(status.message, HasSubstr("shoulder: recovered, enabled in mode cyclic_position"));
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
}

TEST(RecoverProcedure, BootsALostNodeAgain) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.dead = true;
  ASSERT_TRUE(bench.runUntil([&] { return bench.device().health() == fieldbus::Health::lost; }));
  bench.drive.reboot();  // power is back, the boot-up message got lost
  bench.drive.dead = false;
  const ProcedureStatus& status = bench.perform(ProcedureKind::recover);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_EQ(bench.device().health(), fieldbus::Health::ready);
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
}

TEST(RecoverProcedure, SaysWhyANodeDoesNotBoot) {
  Bench bench;
  bench.drive.dead = true;
  const ProcedureStatus& status = bench.perform(ProcedureKind::recover);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("shoulder (node 3): the node did not boot"));
  EXPECT_GT(status.message.size(), 60u);
}

TEST(RecoverProcedure, IsHarmlessOnAnEnabledAxis) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.controlwords.clear();
  EXPECT_TRUE(bench.perform(ProcedureKind::recover).success);
  EXPECT_EQ(bench.drive.controlwords, std::vector<std::uint16_t>{});
}

TEST(RecoverProcedure, DoesNotTakeAMovingAxisFromWhoMovesIt) {
  AxisConfig config = testConfig();
  config.mode = "cyclic_velocity";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.follow(1.0);
  bench.run(milliseconds(200));
  double slowest = 1e9;
  bench.each_cycle = [&] {
    EXPECT_TRUE(bench.axis.setTarget(1.0)) << bench.axis.motionRefusal();
    slowest = std::min(slowest, bench.drive.velocity);
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::recover);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_THAT(status.message, HasSubstr("it was left alone"));
  bench.run(milliseconds(200));
  EXPECT_NEAR(slowest, 10000.0, 1.0);
}

TEST(RecoverProcedure, OfAHaltedAxisNamesTheCallThatReleasesIt) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  EXPECT_TRUE(bench.axis.state().halted);
  const ProcedureStatus& status = bench.perform(ProcedureKind::recover);
  EXPECT_FALSE(status.success);
  EXPECT_EQ(status.message, "shoulder is halted: enable");
  EXPECT_TRUE(bench.axis.state().halted) << "who halted it is not overruled";
  ASSERT_TRUE(bench.enable());
  EXPECT_FALSE(bench.axis.state().halted);
  EXPECT_TRUE(bench.perform(ProcedureKind::recover).success);
}

TEST(RecoverProcedure, AHaltedAxisThatIsSwitchedOffIsNotHaltedAnyMore) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  EXPECT_FALSE(bench.axis.state().halted);
  EXPECT_TRUE(bench.perform(ProcedureKind::recover).success);
}

TEST(RecoverProcedure, FailsWhereHomingIsMissingAndNamesIt) {
  AxisConfig config = testConfig();
  config.homing = HomingOptions();
  config.homing->method = 17;
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::recover);
  EXPECT_FALSE(status.success) << "it takes no position";
  EXPECT_THAT(status.message, HasSubstr("shoulder is not homed: home"));
  EXPECT_EQ(bench.drive.state, FakeDrive::S::enabled);
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  EXPECT_TRUE(bench.perform(ProcedureKind::recover).success);
}

TEST(RecoverProcedure, NeedsNoHomingForVelocities) {
  AxisConfig config = testConfig();
  config.homing = HomingOptions();
  config.homing->method = 17;
  config.mode = "cyclic_velocity";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::recover);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_TRUE(bench.give(0.5));
}

// What was asked for at a fault is answered when that has gone: it is of no fault any more.
TEST(FaultReads, ThatAreAnsweredTooLateAreToldOfTheNextFaultAlone) {
  DriveProfile profile = testProfile();
  profile.supervision.fault_reads = {"1001:00", "1003:01"};
  Bench bench(testConfig(profile));
  bench.drive.dictionary[{0x1001, 0}] = {0x21, 1};
  bench.drive.dictionary[{0x1003, 1}] = {0x8611, 4};
  ASSERT_TRUE(bench.boot());
  std::vector<std::string> told;
  bench.each_cycle = [&, count = bench.axis.noticeCount()]() mutable {
    if (std::exchange(count, bench.axis.noticeCount()) != count) {
      told.push_back(bench.axis.notice());
    }
  };
  bench.fail(0x8611);
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.reads[{0x1001, 0}] == 1; }));
  bench.drive.state = FakeDrive::S::disabled;
  bench.drive.error = 0;
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.drive.reads[(FakeDrive::Key{0x1003, 1})], 0);
  EXPECT_THAT(told, Not(testing::Contains(HasSubstr("at this fault"))));
  bench.fail(0x8611);
  bench.run(milliseconds(200));
  EXPECT_THAT(told,
              testing::Contains("shoulder (node 3): at this fault the drive holds 1001:00 = 0x21 "
                                "(generic, profile), 1003:01 = 0x8611 (following error)"));
}

}  // namespace
}  // namespace cia402::drive
