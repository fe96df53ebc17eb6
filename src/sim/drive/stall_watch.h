// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "sim/drive/motor.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// A motor has stalled that is slower than the role stall_speed, and by more than stall_error (%)
/// behind the speed that it is to have, for longer than stall_time.
class StallWatch {
 public:
  /// One step. @param wanted, is turns/s @return whether it has stalled in this step
  bool step(const DriveValues& values, double wanted, double is) {
    if (!values.has(Role::stall_time)) return false;
    const double share = static_cast<double>(values.raw(Role::stall_error, 0)) / 100.0;
    const bool slow = std::fabs(is) < values.get(Role::stall_speed, 0.0) &&
                      std::fabs(wanted - is) > share * std::fabs(wanted) && wanted != 0.0;
    const double limit = values.get(Role::stall_time, 0.0);
    const bool before = stalled_s_ > limit;
    stalled_s_ = slow ? stalled_s_ + kDriveStepS : 0.0;
    return !before && stalled_s_ > limit;
  }

 private:
  double stalled_s_ = 0.0;
};

}  // namespace cia402::sim
