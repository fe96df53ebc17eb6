// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/trajectory_profile.h"

#include <algorithm>
#include <cmath>

#include "sim/drive/motor.h"

namespace cia402::sim {

double rampVelocity(double velocity, double target, double acceleration, double deceleration) {
  const bool reverses = velocity * target < 0.0;
  const double goal = reverses ? 0.0 : target;
  const bool slows = std::fabs(goal) < std::fabs(velocity);
  const double change = (slows ? deceleration : acceleration) * kDriveStepS;
  return std::clamp(goal, velocity - change, velocity + change);
}

void TrapezoidProfile::reset(double position, double velocity) {
  position_ = position;
  velocity_ = velocity;
}

void TrapezoidProfile::step(double target, const ProfileLimits& limits) {
  const double distance = target - position_;
  const double towards = distance < 0.0 ? -1.0 : 1.0;
  const double remaining = std::fabs(distance);
  // The largest speed for this step after which stopping at the target is still possible:
  // v * dt + v^2 / (2 d) <= remaining, minus half a step since the speed falls within each step.
  const double half = 0.5 * limits.deceleration * kDriveStepS;
  const double reachable =
      std::max(0.0, std::sqrt(half * half + 2.0 * limits.deceleration * remaining) - half);
  const double wanted = towards * std::min(limits.velocity, reachable);
  const double next = rampVelocity(velocity_, wanted, limits.acceleration, limits.deceleration);
  const bool arrives = remaining <= std::fabs(next) * kDriveStepS || remaining < 1e-12;
  if (arrives && next * towards >= 0.0 && std::fabs(next) <= 2.0 * half + reachable) {
    position_ = target;
    velocity_ = 0.0;
    return;
  }
  velocity_ = next;
  position_ += velocity_ * kDriveStepS;
}

void TrapezoidProfile::stop(double deceleration) {
  velocity_ = rampVelocity(velocity_, 0.0, deceleration, deceleration);
  position_ += velocity_ * kDriveStepS;
}

}  // namespace cia402::sim
