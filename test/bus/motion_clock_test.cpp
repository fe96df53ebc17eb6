// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/motion_clock.h"

#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;

TEST(MotionClock, GoesByOnePeriodACycleHoweverLateItIs) {
  MotionClock clock(4ms);
  Time now{1s};
  clock.set(now);
  for (const Duration after : {4ms, 6ms, 2ms, 7ms, 4ms}) {
    now += after;
    clock.cycle(now, false);
    clock.advance(1.0);
  }
  EXPECT_EQ(clock.time(), Time(1s) + 20ms);
}

TEST(MotionClock, BeginsByWhatHasPassedSinceButNeverByMoreThanAPeriod) {
  MotionClock clock(4ms);
  clock.set(Time(1s));
  clock.begin(Time(1s) + 1ms);
  EXPECT_EQ(clock.time(), Time(1s) + 1ms);
  clock.set(Time(1s));
  clock.begin(Time(1s) + 150ms);
  EXPECT_EQ(clock.time(), Time(1s) + 4ms);
}

TEST(MotionClock, StartsFromStandstillAfterMissedCycles) {
  MotionClock clock(4ms);
  Time now{1s};
  clock.set(now);
  clock.cycle(now += 100ms, true);
  EXPECT_EQ(clock.rate(), 0.0);
  clock.advance(25.0);  // a tenth in a cycle
  EXPECT_NEAR(clock.rate(), 0.1, 1e-12);
  EXPECT_EQ(clock.time(), Time(1s) + 400us);
  for (int i = 0; i < 9; ++i) {
    clock.cycle(now += 4ms, false);
    clock.advance(25.0);
  }
  EXPECT_NEAR(clock.rate(), 1.0, 1e-9);
}

TEST(MotionClock, GoesWithTheBusWhileNothingMoves) {
  MotionClock clock(4ms);
  clock.set(Time(1s));
  clock.idle(Time(1s) + 100ms, kNever);
  EXPECT_EQ(clock.time(), Time(1s) + 100ms);
  EXPECT_EQ(clock.at(Time(3s), Time(1s) + 100ms), Time(3s));
  clock.cycle(Time(1s) + 104ms, false);
  EXPECT_EQ(clock.rate(), 1.0);
}

TEST(MotionClock, PassesWhatIsToStartByAPeriodAtMost) {
  MotionClock clock(4ms);
  clock.set(Time(1s));
  clock.idle(Time(1s) + 4ms, Time(1s) + 10ms);
  EXPECT_EQ(clock.time(), Time(1s) + 4ms);
  clock.idle(Time(1s) + 12ms, Time(1s) + 10ms);
  EXPECT_EQ(clock.time(), Time(1s) + 12ms);
  clock.set(Time(1s));
  clock.idle(Time(1s) + 500ms, Time(1s) + 10ms);  // cycles were missed
  EXPECT_EQ(clock.time(), Time(1s) + 14ms);
  EXPECT_EQ(clock.rate(), 1.0);
}

}  // namespace
}  // namespace cia402::bus
