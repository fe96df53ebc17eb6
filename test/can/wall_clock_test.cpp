// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/wall_clock.h"

#include <gtest/gtest.h>

namespace cia402::can {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kWall = 1'700'000'000'000'000'000;  // ns since 1970

Time at(std::int64_t milliseconds) { return Time(Duration(milliseconds * kMs)); }

// Read at 5000 ms on the monotonic clock, empty at 4000 ms before that.
WallClockMapping mappingAt(std::int64_t wall_at_read) {
  WallClockMapping mapping;
  mapping.setEmptyAt(at(4000));
  mapping.setReading({5000 * kMs, wall_at_read});
  return mapping;
}

TEST(WallClockMapping, SubtractsTheAgeOfTheStamp) {
  EXPECT_EQ(mappingAt(kWall).map(kWall - 3 * kMs), at(4997));
  EXPECT_EQ(mappingAt(kWall).map(kWall), at(5000));
}

TEST(WallClockMapping, TakesTheTimeOfTheReadIfTheWallClockWentBackSinceTheStamp) {
  EXPECT_EQ(mappingAt(kWall - 3'600'000 * kMs).map(kWall), at(5000));
}

TEST(WallClockMapping, TakesTheTimeOfTheReadIfTheWallClockWentForwardSinceTheStamp) {
  EXPECT_EQ(mappingAt(kWall + 3'600'000 * kMs).map(kWall), at(5000));
}

TEST(WallClockMapping, BelievesAStampOnlyUpToTheTimeTheSocketWasEmpty) {
  EXPECT_EQ(mappingAt(kWall).map(kWall - 1005 * kMs), at(3995));  // on its way to the socket
  EXPECT_EQ(mappingAt(kWall).map(kWall - 1011 * kMs), at(5000));
}

TEST(WallClockMapping, MapsFramesAfterAStepAsBefore) {
  WallClockMapping mapping = mappingAt(kWall);
  EXPECT_EQ(mapping.map(kWall - kMs), at(4999));
  mapping.setReading({6000 * kMs, kWall - 3'600'000 * kMs});
  EXPECT_EQ(mapping.map(kWall - 3'600'000 * kMs - kMs), at(5999));
}

TEST(ReadClocks, ReadsTheMonotonicClockBetweenItsNeighbours) {
  const Time before = monotonicNow();
  const auto reading = readClocks();
  const Time after = monotonicNow();
  EXPECT_LE(before.time_since_epoch().count(), reading.monotonic);
  EXPECT_GE(after.time_since_epoch().count(), reading.monotonic);
  EXPECT_GT(reading.wall, 1'600'000'000'000'000'000);
}

}  // namespace
}  // namespace cia402::can
