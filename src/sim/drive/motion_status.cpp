// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sim/drive/motion.h"

namespace cia402::sim {
namespace {

constexpr double kStandingSpeed = 1e-3;  // turns/s, where there is no 606Fh
constexpr unsigned kZeroReading = 64;    // every so many readings are 0 while it homes by an object

}  // namespace

void DriveMotion::superviseFollowing() {
  following_error_exceeded_ = false;
  if (!positionControlled() || !values_.has(Role::following_error_window) ||
      values_.allOnes(Role::following_error_window)) {
    following_.reset();
    return;
  }
  const double window = std::fabs(values_.get(Role::following_error_window, 0.0));
  following_error_exceeded_ = following_.step(std::fabs(demand_ - motor_.position()) > window,
                                              values_.get(Role::following_error_timeout, 0.0));
}

void DriveMotion::superviseTargets() {
  const double speed = std::fabs(motor_.velocity());
  at_zero_speed_ = zero_speed_.step(speed <= values_.get(Role::velocity_threshold, kStandingSpeed),
                                    values_.get(Role::velocity_threshold_time, 0.0));
  target_reached_ = false;
  if (mode_ == nullptr) return;
  switch (mode_->behaviour) {
    case ModeBehaviour::profile_position: {
      const bool off = values_.allOnes(Role::position_window);
      const double distance = std::fabs(active_.target - motor_.position());
      const bool inside = off ? demand_ == active_.target
                              : distance <= std::fabs(values_.get(Role::position_window, 0.0));
      const bool reached =
          position_reached_.step(inside, values_.get(Role::position_window_time, 0.0));
      target_reached_ = halted_ ? standing() : reached && !buffered_;
      break;
    }
    case ModeBehaviour::profile_velocity: {
      const double difference = values_.get(Role::target_velocity, 0.0) - motor_.velocity();
      const bool inside =
          std::fabs(difference) <= std::fabs(values_.get(Role::velocity_window, 0.0));
      const bool reached =
          velocity_reached_.step(inside, values_.get(Role::velocity_window_time, 0.0));
      target_reached_ = halted_ ? standing() : reached;
      break;
    }
    case ModeBehaviour::profile_torque:
      target_reached_ = demand_torque_ == values_.get(Role::target_torque, 0.0);
      break;
    default:
      break;
  }
}

std::uint16_t DriveMotion::statusBits() const {
  std::uint16_t bits = 0;
  if (limited_ && definition_.internal_limit_bit) bits |= 0x0800;
  if (mode_ == nullptr) return bits;
  if (mode_->behaviour == ModeBehaviour::homing) return bits | homingBits();
  if (mode_->target_reached && target_reached_) bits |= 0x0400;
  const bool bit_12 = (mode_->bit_12 == Bit12::acknowledge && acknowledged_) ||
                      (mode_->bit_12 == Bit12::zero_speed && at_zero_speed_) ||
                      (mode_->bit_12 == Bit12::follows && !stop_ && !held_);
  if (bit_12) bits |= 0x1000;
  if (mode_->bit_13 == Bit13::following_error && following_error_exceeded_) bits |= 0x2000;
  return bits;
}

void DriveMotion::publish() {
  const double position = motor_.position() - frame_;
  const bool searching = homing_.phase() == HomingSequence::Phase::searching;
  const bool nothing = homesByObject() && searching && ++publications_ % kZeroReading == 0;
  values_.set(Role::position_actual, nothing ? 0.0 : position);
  values_.set(Role::position_internal, position);
  values_.set(Role::velocity_actual, motor_.velocity());
  values_.set(Role::torque_actual, motor_.torque());
  values_.set(Role::current_actual, motor_.torque());
  values_.set(Role::position_demand, demand_ - frame_);
  values_.set(Role::position_demand_internal, demand_ - frame_);
  values_.set(Role::velocity_demand, demand_velocity_);
  values_.set(Role::following_error_actual,
              powered_ && positionControlled() ? demand_ - motor_.position() : 0.0);
  const double turns = motor_.position();
  values_.setRaw(Role::digital_inputs, (switches_.negativeLimit(turns) ? 1 : 0) |
                                           (switches_.positiveLimit(turns) ? 2 : 0) |
                                           (switches_.home(turns) ? 4 : 0));
}

}  // namespace cia402::sim
