// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/trajectory_interpolator.h"

#include <algorithm>

#include "sim/drive/motor.h"

namespace cia402::sim {
namespace {

constexpr double kInstant = 1e-9;  // s: bus time is in nanoseconds

}  // namespace

void LinearInterpolator::reset(double position) {
  position_ = position;
  target_ = position;
  velocity_ = 0.0;
  left_ = 0.0;
  into_ = 0.0;
}

void LinearInterpolator::moveTo(double target, double seconds, double into) {
  const double begin = std::clamp(into, into_, kDriveStepS);
  advance(begin - into_);
  into_ = begin;
  target_ = target;
  left_ = std::clamp(seconds, kDriveStepS, 10.0);
  velocity_ = (target_ - position_) / left_;
}

void LinearInterpolator::step() {
  if (left_ == 0.0 && into_ == 0.0) velocity_ = 0.0;
  advance(kDriveStepS - into_);
  into_ = 0.0;
}

void LinearInterpolator::advance(double seconds) {
  if (left_ == 0.0) return;
  left_ -= seconds;
  if (left_ < kInstant) left_ = 0.0;
  position_ = left_ == 0.0 ? target_ : position_ + velocity_ * seconds;
}

}  // namespace cia402::sim
