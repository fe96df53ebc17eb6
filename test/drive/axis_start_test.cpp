// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How procedures begin, end and give way to each other; what an axis notices meanwhile.
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
using testing::Not;
using S = FakeDrive::S;
using namespace std::chrono_literals;

TEST(AxisStart, CountsProceduresUpAndForgetsHowTheLastOneEnded) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.fail(0x8611);
  bench.run(100ms);
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).remark);
  const std::uint32_t first = bench.axis.procedure().id;
  ASSERT_TRUE(bench.axis.start({ProcedureKind::clear_faults, {}, 0.0}, bench.now).ok());
  const ProcedureStatus& status = bench.axis.procedure();
  EXPECT_EQ(status.id, first + 1);
  EXPECT_TRUE(status.running);
  EXPECT_FALSE(status.success);
  EXPECT_FALSE(status.remark);
  EXPECT_EQ(status.message, "");
  EXPECT_EQ(status.started, bench.now);
  EXPECT_THAT(bench.axis.previousProcedure().message, HasSubstr("shoulder: disabled; "));
}

TEST(AxisStart, ARefusalLeavesTheLastOutcomeAsItIs) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  const std::string message = bench.axis.procedure().message;
  EXPECT_THAT(bench.refusal(ProcedureKind::set_mode, "cst"), Not(HasSubstr("was ended")));
  EXPECT_EQ(bench.axis.procedure().message, message);
  EXPECT_TRUE(bench.axis.procedure().success);
}

TEST(AxisStart, ARefusedStopEndsWhatRuns) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  bench.drive.dead = true;
  ASSERT_TRUE(bench.runUntil([&] { return bench.device().health() == fieldbus::Health::lost; }));
  ASSERT_TRUE(bench.axis.start({ProcedureKind::recover, {}, 0.0}, bench.now).ok());
  bench.run(8ms);
  ASSERT_TRUE(bench.axis.procedure().running);
  EXPECT_THAT(bench.refusal(ProcedureKind::quick_stop), HasSubstr("; recover was ended"));
  EXPECT_FALSE(bench.axis.procedure().running);
  EXPECT_THAT(bench.axis.procedure().message, HasSubstr("recover was stopped by quick_stop"));
}

TEST(AxisStart, RefusalsAreKnownBeforehand) {
  Bench bench;
  EXPECT_THAT(bench.axis.refusal({ProcedureKind::enable, {}, 0.0}),
              HasSubstr("cannot enable: the node is absent"));
  ASSERT_TRUE(bench.boot());
  EXPECT_EQ(bench.axis.refusal({ProcedureKind::enable, {}, 0.0}), "");
  EXPECT_THAT(bench.axis.refusal({ProcedureKind::set_mode, "cst", 0.0}),
              HasSubstr("has no mode \"cst\""));
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  EXPECT_THAT(bench.axis.refusal({ProcedureKind::set_mode, "csv", 0.0}),
              HasSubstr("set_mode is refused while enable runs"));
  EXPECT_EQ(bench.axis.refusal({ProcedureKind::disable, {}, 0.0}), "");
}

TEST(AxisStart, AQuickStopIsNotTakenBackByAHaltInTheSameCycle) {
  AxisConfig config = testConfig();
  config.mode = "cyclic_velocity";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.follow(1.0);
  bench.run(200ms);
  bench.each_cycle = nullptr;
  bench.drive.quick_stop_deceleration = 10000;
  ASSERT_TRUE(bench.axis.start({ProcedureKind::quick_stop, {}, 0.0}, bench.now).ok());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::halt, {}, 0.0}, bench.now).ok());
  bench.run(12ms);
  EXPECT_EQ(bench.drive.controlword, 0x0002);
  EXPECT_EQ(bench.drive.state, S::quick);
}

TEST(AxisStart, AProcedureWhoseNodeIsLostFailsBeforeTheNextOneBegins) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(S::ready);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  bench.run(100ms);
  bench.reboot();
  ASSERT_TRUE(bench.axis.procedure().running);
  bench.refusal(ProcedureKind::disable);
  EXPECT_FALSE(bench.axis.procedure().running);
  EXPECT_FALSE(bench.axis.procedure().success);
  EXPECT_THAT(bench.axis.procedure().message, HasSubstr("enable failed: shoulder (node 3)"));
}

TEST(AxisStart, ALostBusEndsEnabling) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(S::ready);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  bench.run(100ms);
  bench.axis.onBusLost("can0 is bus-off");
  EXPECT_FALSE(bench.axis.procedure().running);
  EXPECT_FALSE(bench.axis.procedure().success);
  EXPECT_EQ(bench.axis.procedure().message,
            "shoulder (node 3): enable was ended: can0 is bus-off: nothing reaches the drive");
}

TEST(AxisStart, ALostBusLeavesADisableAlone) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(100ms);
  bench.drive.stuck.insert(S::enabled);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::disable, {}, 0.0}, bench.now).ok());
  bench.run(100ms);
  bench.axis.onBusLost("can0 is bus-off");
  EXPECT_TRUE(bench.axis.procedure().running);
}

TEST(AxisStart, ALostNodeIsNoticedThoughNobodyTells) {
  AxisConfig config = testConfig();
  config.homing = HomingOptions();
  config.homing->method = 17;
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.perform(ProcedureKind::home).success);
  ASSERT_TRUE(bench.axis.state().homed);
  bench.drive.dead = true;
  ASSERT_TRUE(bench.runUntil([&] { return bench.device().health() == fieldbus::Health::lost; }));
  bench.cycle();
  EXPECT_FALSE(bench.axis.state().homed) << "it may have been switched off and moved";
}

TEST(AxisStart, ACalibrationWaitsForTheEndOfAProcedure) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.run(100ms);
  EXPECT_EQ(bench.axis.calibrationRefusal(), "");
  bench.drive.stuck.insert(S::ready);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  EXPECT_EQ(bench.axis.calibrationRefusal(), "enable runs; wait for its end");
}

/// Limits of +-3.1 rad in the drive, 0.0001 rad a count.
TEST(AxisStart, LimitsThatWereOpenedForAnotherZeroAreClosedWhereThatIsCutOff) {
  DriveProfile profile = testProfile();
  profile.objects.push_back(test::object("upper", 0x607D, DataType::int32, Quantity::position, 2));
  profile.startup = {test::from("upper", "limits.upper")};
  profile.startup[0].when_homed = profile.startup[0].optional = true;
  Bench bench(testConfig(profile));
  auto& upper = bench.drive.dictionary[{0x607D, 2}] = {0, 4};
  ASSERT_TRUE(bench.boot());
  bench.run(100ms);
  ASSERT_EQ(upper.first, 31000u);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::set_position, {}, 0.5}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil([&] { return upper.first == 0x7FFFFFFF; }));
  ASSERT_TRUE(bench.axis.procedure().running);
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  bench.run(100ms);
  EXPECT_EQ(upper.first, 31000u);
  EXPECT_NEAR(bench.axis.state().position, 1.2345, 1e-9);
}

TEST(AxisObjects, ReportsNameTheRpdoThatBringsTheControlword) {
  test::Layout layout = test::testLayout();
  std::swap(layout.outputs[0], layout.outputs[1]);
  layout.outputs[1].name = "RPDO 2 (COB-ID 0x203)";
  Bench bench(testConfig(), layout);
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(S::on);
  EXPECT_THAT(bench.perform(ProcedureKind::enable).message,
              HasSubstr("sent in RPDO 2 (COB-ID 0x203), "));
}

TEST(AxisObjects, ReportsTellThatNoRpdoHasLeft) {
  Bench bench;
  bench.device().boot(bench.now, true);
  for (int i = 0; i < 2000 && !bench.axis.state().feedback_valid; ++i) bench.cycleWithoutOutputs();
  ASSERT_TRUE(bench.axis.state().feedback_valid);
  bench.drive.state = S::on;  // by somebody else
  bench.drive.stuck = {S::on};
  bench.cycleWithoutOutputs();
  ASSERT_TRUE(bench.axis.start({ProcedureKind::disable, {}, 0.0}, bench.now).ok());
  for (int i = 0; i < 2000 && bench.axis.procedure().running; ++i) bench.cycleWithoutOutputs();
  EXPECT_THAT(bench.axis.procedure().message, HasSubstr(", 0 frames so far; "));
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("; no RPDO has left: is the cycle running?"));
  bench.drive.stuck.clear();
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  for (int i = 0; i < 2000 && bench.axis.procedure().running; ++i) bench.cycleWithoutOutputs();
  EXPECT_THAT(bench.axis.procedure().message, HasSubstr("no RPDO has left for 1"));
}

TEST(AxisObjects, AStatuswordIsKnownByItsIndexWhateverItsName) {
  DriveProfile profile = testProfile();
  for (ObjectSpec& object : profile.objects) {
    if (object.name == "statusword") object.name = "status_of_the_drive";
  }
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  EXPECT_EQ(bench.axis.state().state, State::switch_on_disabled);
}

TEST(AxisObjects, AControlwordMustBeMapped) {
  test::Layout layout = test::testLayout();
  layout.outputs[0].objects.erase(layout.outputs[0].objects.begin());
  EXPECT_THROW(Bench(testConfig(), layout), std::invalid_argument);
}

TEST(AxisObjects, ATorqueThatNothingScalesIsUnknown) {
  AxisConfig config = testConfig();
  config.geometry.rated_torque = 0.0;
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(std::isnan(bench.axis.state().effort));
}

TEST(AxisObjects, ATargetCodedLikeThePositionTakesOverItsVeryCounts) {
  for (const bool same : {true, false}) {
    SCOPED_TRACE(same);
    DriveProfile profile = testProfile();
    for (ObjectSpec& object : profile.objects) {
      if (object.name == "target_position" && !same) object.factor = 2.0;
    }
    Bench bench(testConfig(profile));
    bench.drive.position = 12345;
    ASSERT_TRUE(bench.boot());
    bench.run(40ms);
    EXPECT_EQ(bench.drive.target_position, same ? 12345 : 24690);
  }
}

TEST(AxisStart, AStopBySdoEndsEnablingAndReachesTheDriveWithoutRpdos) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.stuck.insert(S::on);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  bench.run(100ms);
  bench.drive.writes.clear();
  bench.axis.stopBesideCycle("no RPDO reaches it");
  EXPECT_FALSE(bench.axis.procedure().running);
  EXPECT_FALSE(bench.axis.procedure().success);
  EXPECT_THAT(bench.axis.procedure().message, HasSubstr("enable was ended: no RPDO reaches it"));
  bench.run(20ms);
  EXPECT_THAT(bench.drive.writes, testing::Contains(std::make_pair(0x6040u, std::uint64_t{2})));
}

TEST(AxisStart, ACalibrationWaitsForTheOneThatIsBeingWritten) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.run(100ms);
  bench.axis.beginCalibration("608F:01");
  EXPECT_EQ(bench.axis.calibrationRefusal(), "608F:01 is being written; call it again");
  bench.axis.endCalibration();
  EXPECT_EQ(bench.axis.calibrationRefusal(), "");
}

}  // namespace
}  // namespace cia402::drive
