// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What an axis says of itself: why it takes no command, and what helps.
#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using testing::Not;

TEST(AxisWords, BeforeItsNodeIsThereTheNodeIsNamed) {
  Bench bench;
  EXPECT_EQ(bench.axis.obstacle(), "shoulder, its node is absent: recover");
  EXPECT_EQ(bench.axis.motionRefusal(),
            "shoulder (node 3): the node is absent; recover brings it back");
  EXPECT_EQ(bench.axis.faultText(), "");
}

TEST(AxisWords, ADisabledAxisAsksToBeEnabled) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  EXPECT_EQ(bench.axis.obstacle(), "shoulder is not enabled (switch on disabled): enable");
  // 0x0250: bits 4, 6 and 9.
  EXPECT_EQ(bench.axis.motionRefusal(),
            "shoulder (node 3): not enabled, statusword 0x0250 (switch on disabled: voltage "
            "enabled, switch on disabled, remote); call enable");
}

TEST(AxisWords, AnAxisThatIsWellSaysNothing) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  EXPECT_EQ(bench.axis.obstacle(), "");
  EXPECT_EQ(bench.axis.motionRefusal(), "");
  EXPECT_EQ(bench.axis.faultText(), "");
}

TEST(AxisWords, AHaltedAxisAsksForEnable) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  EXPECT_EQ(bench.axis.obstacle(), "shoulder is halted: enable");
  EXPECT_EQ(bench.axis.motionRefusal(), "shoulder (node 3): halted; enable releases the halt");
}

TEST(AxisWords, WhileAProcedureRunsThereIsNoMotion) {
  Bench bench;
  bench.drive.mode_delay = 100;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  bench.run(milliseconds(20));
  EXPECT_EQ(bench.axis.motionRefusal(), "shoulder (node 3): a procedure is running");
}

TEST(AxisWords, WithoutFeedbackThatIsSaid) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.drive.silent = true;
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.axis.obstacle(), "shoulder gives no fresh statusword and position: recover");
  EXPECT_EQ(bench.axis.motionRefusal(),
            "shoulder (node 3): no fresh statusword (6041:00) and position (6064:00)");
}

TEST(AxisWords, AFaultIsNamedWithCauseAndRemedy) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.fail(0x8611);
  bench.run(milliseconds(8));
  const std::string words =
      "shoulder (node 3): fault 0x8611 following error: the axis is blocked or the gains are too "
      "low; check the mechanics and 6065:00";
  EXPECT_EQ(bench.axis.faultText(), words + " (the drive is still stopping); then clear_faults");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.axis.faultText(), words + "; then clear_faults");
  EXPECT_EQ(bench.axis.motionRefusal(), words + "; then clear_faults");
  EXPECT_EQ(bench.axis.obstacle(), "shoulder is in fault: recover");
}

TEST(AxisWords, AFaultWithoutACodeSaysWhereToLook) {
  Bench bench;
  bench.drive.error_object = 0;
  ASSERT_TRUE(bench.boot());
  bench.drive.fail(0x8611);  // its EMCY is lost
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.axis.faultText(),
            "shoulder (node 3): fault, no error code yet (603F:00 is 0 and no EMCY came); "
            "clear_faults, then look at the drive's own display or log");
}

TEST(AxisWords, AWarningWithoutACodeMattersWhereWarningsStop) {
  for (const bool stops : {false, true}) {
    DriveProfile profile = test::testProfile();
    profile.warning_stops = stops;
    Bench bench(testConfig(profile));
    bench.drive.warning = true;
    bench.drive.error_object = 0;
    ASSERT_TRUE(bench.boot());
    bench.run(milliseconds(40));
    EXPECT_EQ(
        bench.axis.faultText(),
        stops ? "shoulder (node 3): warning without a code (statusword bit 7); clear_faults" : "");
  }
}

TEST(AxisWords, AnAxisWithoutZeroAsksForWhatGivesItOne) {
  for (const bool homing : {false, true}) {
    AxisConfig config = testConfig();
    if (homing) {
      config.homing.emplace();
      config.homing->method = 37;
      config.homing->search_velocity = config.homing->zero_velocity = 0.1;
      config.homing->acceleration = 1.0;
    }
    Bench bench(config);
    ASSERT_TRUE(bench.boot() && bench.enable());
    EXPECT_EQ(bench.axis.obstacle(), homing ? "shoulder is not homed: home" : "");
    EXPECT_EQ(bench.axis.motionRefusal(),
              homing ? "shoulder (node 3): not homed; home it before position motion" : "");
  }
}

TEST(AxisWords, ADriveThatShowsAnotherModeIsToldApart) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.drive.commanded_mode = bench.drive.mode = 3;  // by itself
  bench.drive.mode_delay = 1000000;
  bench.run(milliseconds(8));
  EXPECT_THAT(bench.axis.obstacle(),
              HasSubstr("shoulder does not show that it is in mode cyclic_position: enable"));
  EXPECT_THAT(bench.axis.motionRefusal(),
              HasSubstr(" instead of 8 (cyclic_position); call enable"));
}

TEST(AxisWords, AStreamThatNobodyWouldEndIsRefusedUntilItIsAllowed) {
  AxisConfig config = testConfig();
  config.mode = "cyclic_velocity";
  for (const bool allowed : {false, true}) {
    config.unwatched_streams = allowed;
    Bench bench(config);
    bench.noticeLostMaster(false);
    ASSERT_TRUE(bench.boot() && bench.enable());
    const auto taken = bench.axis.command(0.5, bench.now);
    EXPECT_EQ(taken.ok(), allowed);
    if (!allowed) {
      EXPECT_EQ(taken.error().message,
                "shoulder (node 3): the node does not notice when this driver dies, and would go "
                "on in mode cyclic_velocity with what it was told last; use a mode of positions, "
                "or say `unwatched_streams: true` of the axis where nobody can come to harm by "
                "that");
    }
    bench.run(milliseconds(100));
    EXPECT_EQ(bench.drive.target_velocity != 0, allowed);
  }
}

TEST(AxisWords, PositionsNeedNobodyWhoWatches) {
  Bench bench;
  bench.noticeLostMaster(false);
  ASSERT_TRUE(bench.boot() && bench.enable());
  EXPECT_TRUE(bench.axis.command(bench.axis.state().position, bench.now).ok());
}

TEST(AxisWords, AStateThatIsKnownNeedsNoWords) {
  Bench bench;
  EXPECT_EQ(bench.axis.unknownText(), "") << "its node is not there: that is told elsewhere";
  ASSERT_TRUE(bench.boot());
  EXPECT_EQ(bench.axis.unknownText(), "");
}

TEST(AxisWords, AStatuswordOfNoStateIsShownWithItsBits) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.silent = true;
  bench.cycle();
  bench.bring({{{0x6041, 0}, 0x0202}, {{0x6064, 0}, 12345}, {{0x6061, 0}, 8}});
  bench.cycle();
  EXPECT_THAT(bench.axis.unknownText(),
              HasSubstr("shoulder (node 3): its state is unknown: statusword (6041:00) 0x0202 is "
                        "none of the states of CiA 402 (switched on, remote)"));
}

TEST(AxisWords, AStateThatNothingTellsIsUnknown) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.silent = true;
  bench.run(milliseconds(200));
  EXPECT_THAT(bench.axis.unknownText(),
              HasSubstr("shoulder (node 3): its state is unknown: no usable statusword (6041:00) "
                        "and position (6064:00): "));
}

TEST(AxisWords, AStatuswordOfZeroIsAStatusword) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.state = FakeDrive::S::start;
  bench.drive.voltage = bench.drive.remote = false;
  bench.run(milliseconds(8));
  EXPECT_EQ(bench.axis.motionRefusal(),
            "shoulder (node 3): not enabled, statusword 0x0000 (not ready to switch on: no bit "
            "set); call enable");
}

TEST(AxisWords, FeedbackIsMissingUntilBothStatuswordAndPositionHaveCome) {
  test::Layout layout = test::testLayout();
  layout.inputs[0].objects = {{{0x6041, 0}, 16}};
  layout.inputs.push_back(test::thirdInput({0x6064, 0}, 32));
  Bench bench(testConfig(), layout);
  bench.device().boot(bench.now, true);
  ASSERT_TRUE(bench.runUntil([&] { return bench.device().health() == fieldbus::Health::ready; }));
  bench.run(milliseconds(8));
  ASSERT_FALSE(bench.axis.state().feedback_valid);
  EXPECT_THAT(bench.axis.unknownText(), Not(HasSubstr("finite")));
}

}  // namespace
}  // namespace cia402::drive
