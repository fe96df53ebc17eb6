// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What has to be on the wire before a procedure goes on: what was computed only, nobody has heard.
#include "drive/procedure_steps.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::testConfig;
using test::testProfile;
using S = FakeDrive::S;
using namespace std::chrono_literals;

struct WireBench : Bench {
  using Bench::Bench;
  void begin(ProcedureKind kind, const std::string& mode = {}) {
    EXPECT_TRUE(axis.start({kind, mode, 0.0}, now).ok());
  }
  bool reach(const std::string& step) {
    return runUntil([&] { return axis.procedure().step == step; });
  }
  void runWithoutOutputs(Duration time) {
    for (const Time end = now + time; now < end;) cycleWithoutOutputs();
  }
  const std::string& step() const { return axis.procedure().step; }
  bool ends() {
    return runUntil([&] { return !axis.procedure().running; }) && axis.procedure().success;
  }
};

AxisConfig homes(DriveProfile profile = testProfile()) {
  AxisConfig config = testConfig(std::move(profile));
  config.homing = HomingOptions();
  config.homing->method = 17;
  return config;
}

TEST(ProcedureFrames, AFaultResetNeedsBitSevenLowOnTheWireFirst) {
  WireBench bench;
  ASSERT_TRUE(bench.boot());
  bench.fail(0x8611);
  bench.run(100ms);
  bench.begin(ProcedureKind::clear_faults);
  bench.runWithoutOutputs(3s);
  EXPECT_FALSE(bench.axis.procedure().running);
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("no RPDO has left for 2 s; is the cycle running?"));
  bench.run(100ms);
  EXPECT_EQ(bench.drive.resets, 0);
}

TEST(ProcedureFrames, AHomingStartsOnceBitFourWasLow) {
  WireBench bench(homes());
  ASSERT_TRUE(bench.boot());
  bench.begin(ProcedureKind::home);
  ASSERT_TRUE(bench.reach("preparing the start"));
  bench.runWithoutOutputs(400ms);
  EXPECT_EQ(bench.step(), "preparing the start");
  EXPECT_TRUE(bench.ends()) << bench.axis.procedure().message;
  EXPECT_EQ(bench.drive.homings, 1);
}

TEST(ProcedureFrames, AHomingIsOverOnceBitFourIsLowAgain) {
  WireBench bench(homes());
  ASSERT_TRUE(bench.boot());
  bench.begin(ProcedureKind::home);
  ASSERT_TRUE(bench.reach("home found"));
  bench.runWithoutOutputs(400ms);
  EXPECT_EQ(bench.step(), "home found");
  EXPECT_TRUE(bench.ends()) << bench.axis.procedure().message;
}

TEST(ProcedureFrames, AHaltIsReleasedOnTheWireBeforeAModeThatItWouldBeInTheWayOf) {
  DriveProfile profile = testProfile();
  profile.mode_change.while_halted = false;
  WireBench bench(homes(profile));
  bench.drive.never_homes = true;
  ASSERT_TRUE(bench.boot());
  bench.begin(ProcedureKind::home);
  ASSERT_TRUE(bench.runUntil([&] { return bench.drive.velocity < 0; }));
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  bench.begin(ProcedureKind::enable);
  bench.runWithoutOutputs(400ms);
  EXPECT_EQ(bench.step(), "starting");
  EXPECT_TRUE(bench.ends()) << bench.axis.procedure().message;
}

TEST(ProcedureFrames, AModeIsCommandedOnTheWireBeforeThePowerComes) {
  DriveProfile profile = testProfile();
  profile.mode_change.shown_when_enabled = true;
  WireBench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.begin(ProcedureKind::enable);
  ASSERT_TRUE(bench.reach("switching the mode"));
  bench.runWithoutOutputs(400ms);
  EXPECT_EQ(bench.step(), "switching the mode");
  EXPECT_TRUE(bench.ends()) << bench.axis.procedure().message;
}

TEST(ProcedureFrames, ATargetThatLeftLateLeavesTheModeItsTime) {
  WireBench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.mode_delay = 125;  // half a second
  bench.begin(ProcedureKind::set_mode, "csv");
  ASSERT_TRUE(bench.reach("setting the target to the actual value"));
  bench.runWithoutOutputs(900ms);
  EXPECT_EQ(bench.step(), "setting the target to the actual value");
  EXPECT_TRUE(bench.ends()) << bench.axis.procedure().message;
}

TEST(ProcedureFrames, ATargetThatDoesNotLeaveEndsInATimeOut) {
  WireBench bench;
  ASSERT_TRUE(bench.boot());
  bench.begin(ProcedureKind::enable);
  ASSERT_TRUE(bench.reach("setting the target to the actual value"));
  bench.runWithoutOutputs(1100ms);
  EXPECT_FALSE(bench.axis.procedure().running);
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("shoulder (node 3): no RPDO has left for 1 s; is the cycle running?"));
  EXPECT_EQ(bench.drive.state, S::disabled);
}

TEST(ProcedureFrames, AModeDisplayThatIsNotMappedIsAskedForOftenButNotInEachCycle) {
  test::Layout layout = test::testLayout();
  layout.inputs[0].objects.pop_back();  // 6061h
  DriveProfile profile = testProfile();
  profile.timing.mode_change = 5s;
  WireBench bench(testConfig(profile), layout);
  ASSERT_TRUE(bench.boot());
  bench.drive.mode = 1;
  bench.drive.mode_delay = 500;
  bench.begin(ProcedureKind::enable);
  ASSERT_TRUE(bench.reach("switching the mode"));
  bench.drive.reads.clear();
  bench.run(1s);
  EXPECT_EQ(bench.step(), "switching the mode");
  const int reads = bench.drive.reads[{0x6061, 0}];
  EXPECT_GT(reads, 25) << "oftener than what is read all the time, each 50 ms";
  EXPECT_LT(reads, 125) << "there are 250 cycles";
  EXPECT_TRUE(bench.ends()) << bench.axis.procedure().message;
}

}  // namespace
}  // namespace cia402::drive
