// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// When set-points are called back from a motor that does not follow them.
#include "drive/axis/follow_watch.h"

#include "drive/follow_watch_bench.h"

namespace cia402::drive {
namespace {

using namespace std::chrono_literals;
using test::kCycle;
using test::kSeen;
using test::kStandstill;
using test::WatchBench;

TEST(FollowWatch, CallsBackWhatRunsAwayFromAStandingMotor) {
  WatchBench bench;
  const auto after = bench.runAhead();
  ASSERT_TRUE(after);
  EXPECT_GT(*after, kSeen);
  EXPECT_LE(*after, 150ms + 3 * kCycle);
  EXPECT_TRUE(bench.watch.isNews());
}

TEST(FollowWatch, IsQuickerWhereTheDriveSaysThatALimitHoldsIt) {
  WatchBench bench;
  bench.state.internal_limit = true;
  const auto after = bench.runAhead();
  ASSERT_TRUE(after);
  EXPECT_GE(*after, 60ms);
  EXPECT_LE(*after, kSeen);
}

TEST(FollowWatch, CallsBackAStreamThatPausesAheadOfAMotorThatALimitHolds) {
  WatchBench bench;
  bench.state.internal_limit = true;
  for (int i = 0; i < 12; ++i) ASSERT_FALSE(bench.cycle(0.0, bench.sent.value() + 0.0004));
  const Time begun = bench.now;
  while (bench.now - begun < 1s && !bench.cycle(0.0, bench.sent.value() + 0.00002)) {  // 5 mrad/s
  }
  EXPECT_LE(bench.now - begun, kSeen);
}

TEST(FollowWatch, CallsBackAStreamThatCreepsAwayFromAMotorThatALimitHolds) {
  WatchBench bench;
  bench.state.internal_limit = true;
  bool called_back = false;
  while (bench.sent.value() < 0.01 && !called_back) {
    called_back = bench.cycle(0.0, bench.sent.value() + 0.00004);  // as fast as standstill
  }
  EXPECT_LT(bench.sent.value(), 0.003);
}

TEST(FollowWatch, IsQuickerWhereTheDriveTakesItsBitAway) {
  WatchBench bench;
  bench.has_bit = bench.bit = true;  // in another mode now: this one has the bit
  bench.stand(20ms);
  bench.bit = false;
  const auto after = bench.runAhead();
  ASSERT_TRUE(after);
  EXPECT_GE(*after, 60ms);
  EXPECT_LE(*after, kSeen);
}

TEST(FollowWatch, CallsAVelocityBackFromAMotorThatALimitHolds) {
  WatchBench bench(SetPointKind::velocity);
  for (int i = 0; i < 500; ++i) ASSERT_FALSE(bench.cycle(0.0, 0.5)) << "a load, says nothing";
  bench.state.internal_limit = true;
  ASSERT_TRUE(bench.cycle(0.0, 0.5));
  WatchBench again(SetPointKind::velocity);
  again.state.internal_limit = true;
  const Time begun = again.now;
  while (again.now - begun < 1s && !again.cycle(0.0, 0.5)) {
  }
  EXPECT_GE(again.now - begun, 60ms);
  EXPECT_LE(again.now - begun, kSeen);
}

TEST(FollowWatch, IsNotQuickerWhereTheDriveNeverSetsItsBit) {
  WatchBench bench;
  bench.has_bit = true;
  bench.watch.begin(bench.now);
  bench.stand(2s);
  const auto after = bench.runAhead();
  ASSERT_TRUE(after);
  EXPECT_GE(*after, 150ms);
}

TEST(FollowWatch, HoldsNothingAgainstAMotorThatWasSeenLastBeforeItsSetPointsRan) {
  WatchBench bench;
  bench.state.internal_limit = true;  // from which it is led away
  bench.heard = false;                // its positions come every 100 ms
  for (int i = 0; i < 25; ++i) {
    ASSERT_FALSE(bench.cycle(0.004 * i, bench.sent.value() + 0.004)) << "cycle " << i;
  }
  bench.heard = true;
  for (int i = 25; i < 100; ++i) {
    ASSERT_FALSE(bench.cycle(0.004 * i, bench.sent.value() + 0.004)) << "cycle " << i;
  }
}

TEST(FollowWatch, LeavesAMotorAloneThatMovesHoweverFarBehind) {
  WatchBench bench;
  double motor = 0.0;
  for (int i = 0; i < 500; ++i) {
    ASSERT_FALSE(bench.cycle(motor, bench.sent.value() + 0.004)) << "cycle " << i;
    motor += 0.0005;  // an eighth as fast
  }
}

TEST(FollowWatch, LeavesSetPointsAloneThatMoveNoFasterThanStandstill) {
  WatchBench bench;
  for (int i = 0; i < 500; ++i) {
    ASSERT_FALSE(bench.cycle(0.0, bench.sent.value() + kStandstill * 0.004));
  }
}

TEST(FollowWatch, CallsBackWhatRestsAheadOfAMotorAtALimit) {
  WatchBench bench;
  bench.state.internal_limit = true;
  for (int i = 0; i < 5; ++i) {  // too short to be called back on the way
    ASSERT_FALSE(bench.cycle(0.0, bench.sent.value() + 0.004));
  }
  const Time rested = bench.now;
  while (bench.now - rested < 1s && !bench.cycle(0.0, bench.sent.value())) {
  }
  EXPECT_GE(bench.now - rested, 60ms - kCycle);
  EXPECT_LE(bench.now - rested, 60ms + 2 * kCycle);
}

TEST(FollowWatch, LeavesWhatRestsAheadAloneWhereNothingSaysThatALimitHoldsTheMotor) {
  WatchBench bench;
  for (int i = 0; i < 5; ++i) ASSERT_FALSE(bench.cycle(0.0, bench.sent.value() + 0.004));
  bench.stand(1s);  // friction, a soft loop
}

TEST(FollowWatch, CallsBackAtOnceWhatTurnsBackTowardsAMotorAtALimit) {
  WatchBench bench;
  bench.state.internal_limit = true;
  for (int i = 0; i < 10; ++i) ASSERT_FALSE(bench.cycle(0.0, bench.sent.value() + 0.004));
  EXPECT_TRUE(bench.cycle(0.0, bench.sent.value() - 0.004));
}

TEST(FollowWatch, LetsSetPointsTurnBackWhereNothingSaysThatTheMotorIsHeld) {
  WatchBench bench;
  for (int i = 0; i < 15; ++i) ASSERT_FALSE(bench.cycle(0.0, bench.sent.value() + 0.004));
  for (int i = 0; i < 10; ++i) {
    ASSERT_FALSE(bench.cycle(0.0, bench.sent.value() - 0.004)) << "cycle " << i;
  }
}

TEST(FollowWatch, CallsBackAtOnceWhatTurnsBackTowardsAMotorThatHadItCalledBackBefore) {
  WatchBench bench;
  ASSERT_TRUE(bench.runAhead());
  ASSERT_TRUE(bench.watch.isNews());
  bench.sent.rest(SetPointKind::stream, 0.0);
  bench.watch.end();
  for (int i = 0; i < 10; ++i) ASSERT_FALSE(bench.cycle(0.0, bench.sent.value() + 0.004));
  EXPECT_TRUE(bench.cycle(0.0, bench.sent.value() - 0.004));
}

TEST(FollowWatch, TellsOnceUntilTheMotorMoves) {
  WatchBench bench;
  ASSERT_TRUE(bench.runAhead());
  EXPECT_TRUE(bench.watch.isNews());
  EXPECT_FALSE(bench.watch.isNews());
  for (int i = 0; i < 20; ++i) bench.cycle(0.004 * i);
  EXPECT_TRUE(bench.watch.isNews());
}

TEST(FollowWatch, WaitsOnceForADriveThatNeverShowsItsBit) {
  WatchBench bench;
  bench.has_bit = true;
  bench.watch.begin(bench.now);
  const Time begun = bench.now;
  while (bench.now - begun < 2s && !bench.watch.follows()) bench.cycle(0.0, 0.0);
  EXPECT_GE(bench.now - begun, 1s);
  EXPECT_LT(bench.now - begun, 1s + kCycle);
  bench.watch.begin(bench.now);
  EXPECT_FALSE(bench.watch.follows());
  bench.cycle(0.0, 0.0);
  EXPECT_TRUE(bench.watch.follows()) << "it is known by now";
}

TEST(FollowWatch, DoesNotTakeADriveThatIsHeldForOneThatNeverShowsItsBit) {
  WatchBench bench;
  bench.has_bit = bench.held = true;
  bench.watch.begin(bench.now);
  bench.stand(900ms);
  EXPECT_FALSE(bench.watch.follows());
  bench.stand(200ms);
  EXPECT_TRUE(bench.watch.follows()) << "it is not waited for any longer, this time";
  bench.held = false;
  bench.stand(3s);
  bench.watch.begin(bench.now);
  bench.stand(900ms);
  EXPECT_FALSE(bench.watch.follows());
}

TEST(FollowWatch, WaitsAgainForADriveThatShowsItsBitAfterAll) {
  WatchBench bench;
  bench.has_bit = true;
  bench.watch.begin(bench.now);
  bench.stand(2s);
  ASSERT_TRUE(bench.watch.follows()) << "it seemed to have none";
  bench.bit = true;
  bench.cycle(0.0, 0.0);
  bench.bit = false;
  bench.watch.begin(bench.now);
  bench.cycle(0.0, 0.0);
  EXPECT_FALSE(bench.watch.follows());
}

TEST(FollowWatch, AMotorThatMovesIsStillWaitedForUntilItsBitIsSeen) {
  WatchBench bench;
  bench.has_bit = true;
  bench.watch.begin(bench.now);
  EXPECT_FALSE(bench.watch.leaves(true, true, bench.now)) << "the bit is to be looked for";
  EXPECT_FALSE(bench.watch.leaves(true, false, bench.now)) << "or that there is none";
  bench.bit = true;
  bench.cycle(0.0, 0.0);
  EXPECT_TRUE(bench.watch.leaves(true, true, bench.now));
  EXPECT_FALSE(bench.watch.leaves(false, true, bench.now));
}

TEST(FollowWatch, AModeWithoutTheBitSaysNothingOfOneThatHasIt) {
  WatchBench bench;
  bench.stand(2s);  // homing, say: the brake still holds
  bench.has_bit = true;
  bench.cycle(0.0, 0.0);
  EXPECT_FALSE(bench.watch.follows()) << "and is not counted as one that never shows it";
  bench.bit = true;
  bench.cycle(0.0, 0.0);
  EXPECT_TRUE(bench.watch.follows());
}

TEST(FollowWatch, FollowsAtOnceWhereTheBitIsSetOrTheModeHasNone) {
  WatchBench bench;
  EXPECT_TRUE(bench.watch.follows());
  bench.has_bit = true;
  bench.watch.begin(bench.now);
  bench.cycle(0.0, 0.0);
  EXPECT_FALSE(bench.watch.follows());
  bench.bit = true;
  bench.cycle(0.0, 0.0);
  EXPECT_TRUE(bench.watch.follows());
}

TEST(FollowWatch, BeforeItBeginsItKnowsNothing) {
  FollowWatch watch{kStandstill, kCycle};
  EXPECT_FALSE(watch.follows());
  EXPECT_FALSE(watch.leaves(true, true, Time{1s})) << "the bit has not been seen";
  EXPECT_TRUE(watch.isNews());
}

TEST(FollowWatch, GivesANegativeVelocityAtALimitItsTimeToo) {
  WatchBench bench(SetPointKind::velocity);
  bench.state.internal_limit = true;
  const Time begun = bench.now;
  while (bench.now - begun < 1s && !bench.cycle(0.0, -0.5)) {
  }
  EXPECT_GE(bench.now - begun, 60ms);
  EXPECT_LE(bench.now - begun, kSeen);
}

TEST(FollowWatch, CountsAnewWhereSetPointsHavePaused) {
  WatchBench bench;
  ASSERT_FALSE(bench.runAhead(100ms));
  bench.stand(500ms);
  const auto after = bench.runAhead();
  ASSERT_TRUE(after);
  EXPECT_GE(*after, 150ms);
}

TEST(FollowWatch, CountsAnewWhereALimitHoldsTheMotorOnceMore) {
  WatchBench bench;
  ASSERT_FALSE(bench.runAhead(100ms));
  const auto creep = [&] { return bench.cycle(0.0, bench.sent.value() + 0.02 * 0.004); };
  bench.state.internal_limit = true;
  ASSERT_FALSE(creep());
  bench.state.internal_limit = false;
  for (int i = 0; i < 125; ++i) ASSERT_FALSE(creep());
  bench.state.internal_limit = true;
  const Time held = bench.now;
  while (bench.now - held < 1s && !creep()) {
  }
  EXPECT_GE(bench.now - held, Standstill::kWindow) << "stood for a window since";
  EXPECT_LE(bench.now - held, kSeen);
}

TEST(FollowWatch, AMotorThatMovesInAModeWithoutTheBitSaysNothingOfOneThatHasIt) {
  WatchBench bench;
  for (const Time end = bench.now + 2s; bench.now < end; bench.now += kCycle) {
    ASSERT_TRUE(bench.watch.leaves(true, false, bench.now));
  }
  bench.has_bit = true;
  bench.cycle(0.0, 0.0);
  EXPECT_FALSE(bench.watch.follows()) << "its bit is waited for from now on";
}

TEST(FollowWatch, AMotorThatIsLeftAloneMakesTheNextCallNews) {
  WatchBench bench;
  ASSERT_TRUE(bench.runAhead());
  ASSERT_TRUE(bench.watch.isNews());
  ASSERT_FALSE(bench.watch.isNews());
  ASSERT_TRUE(bench.watch.leaves(true, false, bench.now));
  EXPECT_TRUE(bench.watch.isNews());
}

}  // namespace
}  // namespace cia402::drive
