// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

namespace cia402 {

/// The time base of everything below `bus/`: nanoseconds since an arbitrary start.
/// It has no `now()` on purpose: time is always an argument, so that the whole stack runs in
/// virtual time as well as on CLOCK_MONOTONIC.
struct BusClock {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = std::chrono::duration<rep, period>;
  using time_point = std::chrono::time_point<BusClock, duration>;
  static constexpr bool is_steady = true;
};

using Time = BusClock::time_point;
using Duration = BusClock::duration;

/// "Never": the deadline of something that waits for nothing.
inline constexpr Time kNever = Time::max();

/// Seconds as a double to a duration, rounded to the nearest nanosecond.
constexpr Duration fromSeconds(double seconds) {
  return Duration(static_cast<std::int64_t>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5)));
}

/// A duration in seconds.
constexpr double toSeconds(Duration duration) {
  return static_cast<double>(duration.count()) * 1e-9;
}

}  // namespace cia402
