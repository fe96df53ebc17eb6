// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/stop_ramp.h"

#include <algorithm>
#include <cmath>

namespace cia402::motion {

void StopRamp::begin(double position, double velocity, double deceleration) {
  position_ = position;
  velocity_ = std::isfinite(velocity) ? velocity : 0.0;
  deceleration_ = deceleration;
}

void StopRamp::advance(Duration dt) {
  if (finished() || dt <= Duration::zero()) return;
  const double to_rest = std::fabs(velocity_) / deceleration_;
  const double seconds = std::min(toSeconds(dt), to_rest);
  const double before = velocity_;
  if (seconds >= to_rest) {
    velocity_ = 0.0;
  } else {
    velocity_ -= std::copysign(deceleration_ * seconds, velocity_);
  }
  position_ += 0.5 * (before + velocity_) * seconds;
}

}  // namespace cia402::motion
