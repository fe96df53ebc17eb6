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

}  // namespace cia402::bus
