// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// When a drive that goes to a goal by itself, and does not, has it called back.
#include "drive/axis/follow_watch.h"

#include "drive/follow_watch_bench.h"

namespace cia402::drive {
namespace {

using namespace std::chrono_literals;
using test::kCycle;
using test::WatchBench;

TEST(FollowWatchGoals, GivesADriveThatPlansUntilItHasStoodForAWhileAtALimit) {
  WatchBench bench(SetPointKind::goal);
  bench.state.internal_limit = true;
  ASSERT_FALSE(bench.cycle(0.0, 0.5));
  const Time begun = bench.now;
  while (bench.now - begun < 1s && !bench.cycle(0.0)) {
  }
  EXPECT_GE(bench.now - begun, 300ms - kCycle);
  EXPECT_LE(bench.now - begun, 300ms + 2 * kCycle);
}

// A stepper whose following error is no fault: only the bit of its mode tells of it.
TEST(FollowWatchGoals, GivesAGoalUpWhereTheDriveSaysThatItsMotorStaysBehind) {
  for (const bool tells : {false, true}) {
    ModeSpec mode;
    mode.kind = ControlKind::position;
    mode.following_error_bit = 13;
    WatchBench bench(SetPointKind::goal);
    bench.state.mode = &mode;
    bench.state.statusword = tells ? 0x2000 : 0x1000;
    EXPECT_FALSE(bench.cycle(0.0, 0.5));
    bool called_back = false;
    for (int i = 0; i < 250 && !called_back; ++i) called_back = bench.cycle(0.0);
    EXPECT_EQ(called_back, tells);
  }
}

// Where it may tell "target reached", though it went nowhere.
TEST(FollowWatchGoals, GivesAGoalUpThatADriveDoesNotGoToWhileAWarningHoldsIt) {
  for (const bool warned : {true, false}) {
    WatchBench bench(SetPointKind::goal);
    bench.warned = warned;
    bench.state.target_reached = true;
    const Time given = bench.now;
    bool back = bench.cycle(0.0, 0.5);
    while (!back && bench.now < given + 2s) back = bench.cycle(0.0);
    EXPECT_EQ(back, warned);
    EXPECT_LE(bench.now - given, warned ? 300ms + 3 * kCycle : 2s);
  }
}

TEST(FollowWatchGoals, AGoalThatIsReachedIsNotCalledBack) {
  WatchBench bench(SetPointKind::goal);
  bench.state.internal_limit = bench.state.target_reached = true;
  ASSERT_FALSE(bench.cycle(0.0, 0.5));
  for (int i = 0; i < 500; ++i) ASSERT_FALSE(bench.cycle(0.0));
}

TEST(FollowWatchGoals, AGoalIsNotCalledBackBeforeTheAxisIsReadyForIt) {
  WatchBench bench(SetPointKind::goal);
  bench.state.internal_limit = true;
  bench.state.ready_for_motion = false;
  ASSERT_FALSE(bench.cycle(0.0, 0.5));
  for (int i = 0; i < 500; ++i) ASSERT_FALSE(bench.cycle(0.0));
}

}  // namespace
}  // namespace cia402::drive
