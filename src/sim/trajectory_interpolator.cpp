// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "trajectory_interpolator.h"

#include <algorithm>
#include <cmath>

#include "motor.h"

namespace cia402::sim {

void LinearInterpolator::reset(double position) {
  position_ = position;
  target_ = position;
  velocity_ = 0.0;
  steps_left_ = 0;
}

void LinearInterpolator::moveTo(double target, double seconds) {
  target_ = target;
  steps_left_ = std::max(1L, std::lround(std::clamp(seconds, 0.0, 10.0) / kDriveStepS));
  velocity_ = (target_ - position_) / (static_cast<double>(steps_left_) * kDriveStepS);
}

void LinearInterpolator::step() {
  if (steps_left_ == 0) {
    velocity_ = 0.0;
    return;
  }
  --steps_left_;
  position_ = steps_left_ == 0 ? target_ : position_ + velocity_ * kDriveStepS;
}

}  // namespace cia402::sim
