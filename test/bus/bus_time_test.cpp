// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/bus_time.h"

#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;

/// Bus time on a clock that the test sets; it begins at 100 s.
struct BusTimeTest : testing::Test {
  BusTime make(BusTime::Kind kind) {
    return BusTime(kind, [this] { return clock; });
  }
  Time at(Duration duration) const { return start + duration; }

  const Time start{100s};
  Time clock = start;
};

TEST_F(BusTimeTest, OfARealBusIsTheClocksWhateverIsDue) {
  BusTime time = make(BusTime::Kind::real);
  EXPECT_EQ(time.advance(at(1ms)), start);
  clock = at(10s);
  EXPECT_EQ(time.advance(at(1ms)), at(10s));
  EXPECT_EQ(time.now(), at(10s));
  EXPECT_EQ(time.toClock(at(5s)), at(5s));
  EXPECT_EQ(time.fromClock(at(5s)), at(5s));
  EXPECT_EQ(time.lost(), 0s);
}

TEST_F(BusTimeTest, FollowsTheClockWhileNothingIsDue) {
  BusTime time = make(BusTime::Kind::simulated);
  EXPECT_EQ(time.advance(kNever), start);
  clock = at(3ms);
  EXPECT_EQ(time.advance(at(4ms)), at(3ms));
  EXPECT_EQ(time.now(), at(3ms));
}

TEST_F(BusTimeTest, PassesNoEventThatIsDueAndCatchesUp) {
  BusTime time = make(BusTime::Kind::simulated);
  time.advance(kNever);
  clock = at(49ms);
  EXPECT_EQ(time.advance(at(4ms)), at(4ms));
  EXPECT_EQ(time.advance(at(6ms)), at(6ms));
  EXPECT_EQ(time.advance(kNever), at(49ms));
  EXPECT_EQ(time.lost(), 0s);
}

TEST_F(BusTimeTest, StandsStillDuringAStall) {
  BusTime time = make(BusTime::Kind::simulated);
  time.advance(kNever);
  clock = at(5s);
  EXPECT_EQ(time.advance(at(4ms)), start);
  EXPECT_EQ(time.lost(), 5s);
  clock = at(5s + 10ms);
  EXPECT_EQ(time.advance(at(4ms)), at(4ms));
  EXPECT_EQ(time.advance(kNever), at(10ms));
}

TEST_F(BusTimeTest, IsNotHeldForEverByWhatWasDueAndIsNotDone) {
  BusTime time = make(BusTime::Kind::simulated);
  time.advance(kNever);
  clock = at(10ms);
  const Time first = time.advance(start);
  EXPECT_GT(first, start);
  EXPECT_GT(time.advance(Time::min()), first);
}

TEST_F(BusTimeTest, OtherThreadsSeeItStandDuringAStallAndNeverBehindTheThread) {
  BusTime time = make(BusTime::Kind::simulated);
  EXPECT_EQ(time.now(), start);  // not started
  time.advance(kNever);
  clock = at(5s);
  EXPECT_EQ(time.now(), at(BusTime::kCatchUp));
  time.advance(kNever);
  EXPECT_EQ(time.now(), start);
}

TEST_F(BusTimeTest, AMomentKeepsItsTimeByTheClockWhenMoreIsLost) {
  BusTime time = make(BusTime::Kind::simulated);
  time.advance(kNever);
  clock = at(20ms);
  time.advance(kNever);
  clock = at(5020ms);
  time.advance(kNever);  // 5 s lost at 20 ms
  EXPECT_EQ(time.toClock(at(10ms)), at(10ms));
  EXPECT_EQ(time.toClock(at(20ms)), at(20ms));
  EXPECT_EQ(time.toClock(at(21ms)), at(5021ms));
  clock = at(5030ms);
  time.advance(kNever);
  clock = at(7030ms);
  time.advance(kNever);  // 2 s more at 30 ms
  EXPECT_EQ(time.lost(), 7s);
  EXPECT_EQ(time.toClock(at(20ms)), at(20ms));
  EXPECT_EQ(time.toClock(at(30ms)), at(5030ms));
  EXPECT_EQ(time.toClock(at(1s)), at(8s));
}

TEST_F(BusTimeTest, TimesOfTheClockAreMomentsOnTheBus) {
  BusTime time = make(BusTime::Kind::simulated);
  time.advance(kNever);
  clock = at(20ms);
  time.advance(kNever);
  clock = at(5020ms);
  time.advance(kNever);
  EXPECT_EQ(time.fromClock(at(10ms)), at(10ms));
  EXPECT_EQ(time.fromClock(at(3s)), at(20ms));
  EXPECT_EQ(time.fromClock(at(5020ms)), at(20ms));
  EXPECT_EQ(time.fromClock(at(6020ms)), at(1020ms));
}

TEST_F(BusTimeTest, ForgetsTheOldestOfManyLossesAndKeepsTheirSum) {
  BusTime time = make(BusTime::Kind::simulated);
  time.advance(kNever);
  const int losses = static_cast<int>(BusTime::kLosses) + 10;
  for (int i = 0; i < losses; ++i) {
    clock += 1ms;
    time.advance(kNever);
    clock += 1s;
    time.advance(kNever);
  }
  EXPECT_EQ(time.lost(), losses * 1s);
  const Time newest = start + losses * 1ms;
  EXPECT_EQ(time.advance(kNever), newest);
  EXPECT_EQ(time.toClock(newest), newest + (losses - 1) * 1s);
  EXPECT_EQ(time.toClock(start), start + 10s);
  EXPECT_EQ(time.fromClock(clock), newest);
}

}  // namespace
}  // namespace cia402::bus
