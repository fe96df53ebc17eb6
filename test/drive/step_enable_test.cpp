// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What switching on waits for.
#include <algorithm>
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
  bool on = false;
  bench.each_cycle = [&] { on |= bench.drive.state != S::disabled; };
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_FALSE(on);
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

}  // namespace
}  // namespace cia402::drive
