// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <utility>

#include "sim/drive/motor.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// What a drive tells of its motor's speed: displays may be slower than the motor (role
/// velocity_filter), and it has stalled where it is slower than the role stall_speed, and by more
/// than stall_error (%) behind the speed that it is to have, for longer than stall_time.
class MotorWatch {
 public:
  /// One step. @param wanted turns/s; @param rests it stands, without power
  void step(const DriveValues& values, double wanted, double is, bool rests) {
    const double time = values.get(Role::velocity_filter, 0.0);
    shown_ = time <= kDriveStepS || rests ? is : shown_ + (is - shown_) * kDriveStepS / time;
    if (values.has(Role::stall_time)) watchStall(values, wanted, is);
  }
  double shown() const { return shown_; }  ///< turns/s
  /// It has stalled since that was asked last.
  bool takeStall() { return std::exchange(stalled_, false); }

 private:
  void watchStall(const DriveValues& values, double wanted, double is) {
    const double share = static_cast<double>(values.raw(Role::stall_error, 0)) / 100.0;
    const bool slow = std::fabs(is) < values.get(Role::stall_speed, 0.0) &&
                      std::fabs(wanted - is) > share * std::fabs(wanted) && wanted != 0.0;
    const double limit = values.get(Role::stall_time, 0.0);
    const bool before = stalled_s_ > limit;
    stalled_s_ = slow ? stalled_s_ + kDriveStepS : 0.0;
    stalled_ = stalled_ || (!before && stalled_s_ > limit);
  }

  double shown_ = 0.0, stalled_s_ = 0.0;
  bool stalled_ = false;
};

}  // namespace cia402::sim
