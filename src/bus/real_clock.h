// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>

#include "cia402_driver/common/time.h"

namespace cia402::bus {

/// The time base of the real world: CLOCK_MONOTONIC.
inline Time realNow() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return Time(std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec));
}

/// What the wall clock (CLOCK_REALTIME, since 1970) is ahead of it at the moment.
inline Duration wallClockDistance() {
  timespec wall{};
  const Time before = realNow();
  clock_gettime(CLOCK_REALTIME, &wall);
  const Time after = realNow();
  return Duration(std::chrono::seconds(wall.tv_sec) + std::chrono::nanoseconds(wall.tv_nsec)) -
         (before + (after - before) / 2).time_since_epoch();
}

}  // namespace cia402::bus
