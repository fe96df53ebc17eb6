// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/motor.h"

#include <algorithm>
#include <cmath>

namespace cia402::sim {
namespace {

constexpr double kVelocityLoopShare = 0.25;  // of the position time constant: critical damping
constexpr double kRestDistance = 1e-9;       // turns; below it a held rotor stands exactly
constexpr double kRestVelocity = 1e-6;       // turns/s
constexpr double kBrakingReserve = 0.7;      // of the torque, when the position loop plans a stop

}  // namespace

Motor::Motor(const MotorParameters& parameters, double position)
    : parameters_(parameters),
      forward_limit_(parameters.max_torque),
      reverse_limit_(parameters.max_torque),
      position_(position) {
  setPositionTimeConstant(parameters.position_time_constant);
}

void Motor::limitTorque(double forward, double reverse) {
  forward_limit_ = std::clamp(forward, 0.0, parameters_.max_torque);
  reverse_limit_ = std::clamp(reverse, 0.0, parameters_.max_torque);
}

double Motor::allowed(double torque) const {
  return std::clamp(torque, -reverse_limit_, forward_limit_);
}

void Motor::setPositionTimeConstant(double seconds) {
  parameters_.position_time_constant = std::max(seconds, kDriveStepS);
  const double lag = kVelocityLoopShare * parameters_.position_time_constant;
  velocity_gain_ = 1.0 - std::exp(-kDriveStepS / lag);
}

void Motor::setStops(double low, double high) {
  lowest_ = mirrored_ ? -high : low;
  highest_ = mirrored_ ? -low : high;
}

void Motor::mirror(bool mirrored) {
  if (mirrored == mirrored_) return;
  mirrored_ = mirrored;
  position_ = -position_;
  velocity_ = -velocity_;
  last_demand_.reset();
}

/// One step at the present speed, as far as the stops let it.
void Motor::turn() {
  const double wanted = position_ + velocity_ * kDriveStepS;
  position_ = std::clamp(wanted, std::min(lowest_, position_), std::max(highest_, position_));
  if (position_ != wanted) velocity_ = 0.0;
}

double Motor::brakingSpeed(double distance) const {
  const double torque = std::min(forward_limit_, reverse_limit_);
  const double deceleration = kBrakingReserve * torque * parameters_.rated_acceleration;
  return std::sqrt(2.0 * deceleration * distance);
}

void Motor::accelerate(double wanted) {
  const double direction = velocity_ != 0.0 ? velocity_ : wanted;
  const double friction = direction == 0.0 ? 0.0 : std::copysign(parameters_.friction, direction);
  torque_ = allowed(wanted / parameters_.rated_acceleration + friction);
  if (blocked_) {
    velocity_ = 0.0;
    return;
  }
  if (reversed_) return runAway();
  const double drive = torque_ - friction;
  const bool stuck = velocity_ == 0.0 && drive * direction <= 0.0;  // friction never pushes
  if (!stuck) velocity_ += drive * parameters_.rated_acceleration * kDriveStepS;
  turn();
}

/// One step by a torque of the wrong sign.
void Motor::runAway() {
  const double push = -torque_;
  const double friction = std::copysign(parameters_.friction, velocity_ != 0.0 ? velocity_ : push);
  const bool stuck = velocity_ == 0.0 && std::fabs(push) <= parameters_.friction;
  if (!stuck) velocity_ += (push - friction) * parameters_.rated_acceleration * kDriveStepS;
  velocity_ = std::clamp(velocity_, -parameters_.max_speed, parameters_.max_speed);
  turn();
}

void Motor::followPosition(double demand, const Offsets& offsets) {
  const double error = demand - position_;
  // A demand that takes over from a speed or a torque goes on as the rotor turns.
  const double demand_speed = last_demand_ ? (demand - *last_demand_) / kDriveStepS : velocity_;
  last_demand_ = demand;
  const double distance = std::fabs(error);
  const bool led = offsets.velocity != 0.0 || offsets.torque != 0.0;
  if (distance < kRestDistance && std::fabs(velocity_) < kRestVelocity && !blocked_ && !led) {
    position_ = demand;
    velocity_ = 0.0;
    torque_ = 0.0;
    return;
  }
  // The demand has just moved on by a step: seen after the step the lag is the time constant's.
  const double lag = parameters_.position_time_constant + kDriveStepS;
  const double approach =
      brakingSpeed(distance) + std::max(0.0, std::copysign(1.0, error) * demand_speed);
  const double most = parameters_.max_speed;
  double speed = std::copysign(std::min(std::min(distance / lag, approach), most), error);
  if (led) {
    speed =
        std::clamp((error - offsets.velocity * kDriveStepS) / lag + offsets.velocity, -most, most);
  }
  accelerate((speed - velocity_) * velocity_gain_ / kDriveStepS +
             offsets.torque * parameters_.rated_acceleration);
}

void Motor::followVelocity(double demand, double torque_offset) {
  last_demand_.reset();
  if (demand == 0.0 && torque_offset == 0.0 && std::fabs(velocity_) < kRestVelocity) {
    velocity_ = 0.0;
    torque_ = 0.0;
    return;
  }
  accelerate((demand - velocity_) * velocity_gain_ / kDriveStepS +
             torque_offset * parameters_.rated_acceleration);
}

void Motor::applyTorque(double rated_torques, double max_speed) {
  last_demand_.reset();
  const double torque = allowed(rated_torques);
  const double friction = parameters_.friction;
  double push = 0.0;  // what is left of the torque after friction
  if (velocity_ != 0.0) {
    push = torque - std::copysign(friction, velocity_);
    const bool stops = push * velocity_ < 0.0 && std::fabs(torque) <= friction &&
                       std::fabs(velocity_) <= -push * parameters_.rated_acceleration *
                                                   kDriveStepS * std::copysign(1.0, velocity_);
    if (stops) {
      velocity_ = 0.0;
      torque_ = torque;
      return;
    }
  } else if (std::fabs(torque) > friction) {
    push = torque - std::copysign(friction, torque);
  }
  double wanted = push * parameters_.rated_acceleration;
  const double next = velocity_ + wanted * kDriveStepS;
  if (std::fabs(next) > max_speed && std::fabs(next) > std::fabs(velocity_) * 0.999) {
    wanted = (std::copysign(max_speed, next) - velocity_) * velocity_gain_ / kDriveStepS;
  }
  accelerate(wanted);
  if (velocity_ == 0.0) torque_ = torque;
}

void Motor::coast() {
  last_demand_.reset();
  torque_ = 0.0;
  if (velocity_ == 0.0) return;
  const double torque = parameters_.friction + (shorted_ ? parameters_.dynamic_brake : 0.0);
  const double deceleration =
      torque * parameters_.rated_acceleration + parameters_.viscous_friction * std::fabs(velocity_);
  const double loss = deceleration * kDriveStepS;
  velocity_ =
      blocked_ || std::fabs(velocity_) <= loss ? 0.0 : velocity_ - std::copysign(loss, velocity_);
  turn();
}

}  // namespace cia402::sim
