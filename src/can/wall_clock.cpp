// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/wall_clock.h"

#include <ctime>

#include <limits>

namespace cia402::can {
namespace {

// A frame gets its stamp in the driver's interrupt and its place in the socket a little later.
constexpr Duration kDeliveryTime{10'000'000};
constexpr std::int64_t kGoodEnough = 20'000;  // ns between the two looks at the monotonic clock
constexpr int kTries = 3;

std::int64_t readClock(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

Time monotonicNow() { return Time(Duration(readClock(CLOCK_MONOTONIC))); }

WallClockMapping::Reading readClocks() {
  WallClockMapping::Reading best;
  std::int64_t smallest_gap = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < kTries && smallest_gap > kGoodEnough; ++i) {  // again if interrupted between
    const std::int64_t before = readClock(CLOCK_MONOTONIC);
    const std::int64_t wall = readClock(CLOCK_REALTIME);
    const std::int64_t gap = readClock(CLOCK_MONOTONIC) - before;
    if (gap >= smallest_gap) continue;
    smallest_gap = gap;
    best = {before + gap / 2, wall};
  }
  return best;
}

Time WallClockMapping::map(std::int64_t wall_stamp) const {
  const Time read_at = timeOfReading();
  const Time mapped = read_at - Duration(reading_.wall - wall_stamp);
  const bool too_early = empty_at_ != Time::min() && mapped < empty_at_ - kDeliveryTime;
  return mapped > read_at || too_early ? read_at : mapped;
}

}  // namespace cia402::can
