// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sim/drive/motion.h"

namespace cia402::sim {
namespace {

constexpr double kHard = 300.0;  // turns/s^2 where there is no 609Ah

}  // namespace

void DriveMotion::startHoming() {
  const HomingMethod* method = findHomingMethod(values_.raw(Role::homing_method, 0));
  homing_attained_ = false;
  homing_failed_ = method == nullptr;
  homing_returning_ = false;
  homing_.stop();
  if (method == nullptr) return;
  homing_.start(*method, switches_, motor_.position());
  if (homing_.phase() == HomingSequence::Phase::found) finishHoming();
}

void DriveMotion::homeByObject() {
  if (mode_ != nullptr && mode_->behaviour == ModeBehaviour::homing) startHoming();
}

void DriveMotion::finishHoming() {
  const double offset = values_.get(Role::home_offset, 0.0);
  frame_ = homing_.home() - (definition_.home_offset_is_zero_shift ? -offset : offset);
  homing_attained_ = true;
  homing_returning_ = definition_.homing_returns;
}

void DriveMotion::stepHoming(double from) {
  const double acceleration = values_.get(Role::homing_acceleration, kHard);
  const bool searching = homing_.phase() == HomingSequence::Phase::searching;
  if (homing_returning_) {
    profile_.reset(demand_, demand_velocity_);
    const double speed = values_.get(Role::homing_zero_speed, 0.0);
    profile_.step(homing_.home(), {speed, acceleration, acceleration});
    demand_ = profile_.position();
    demand_velocity_ = profile_.velocity();
    if (demand_ == homing_.home() && demand_velocity_ == 0.0) homing_returning_ = false;
  } else {
    const double speed =
        values_.get(homing_.slow() ? Role::homing_zero_speed : Role::homing_search_speed, 0.0);
    const double target = searching ? homing_.direction() * std::fabs(speed) : 0.0;
    demand_velocity_ = rampVelocity(demand_velocity_, target, acceleration, acceleration);
    demand_ += demand_velocity_ * kDriveStepS;
  }
  motor_.followPosition(demand_);
  if (!searching) return;
  homing_.step(switches_, from, motor_.position());
  if (homing_.phase() == HomingSequence::Phase::found) finishHoming();
  if (homing_.phase() == HomingSequence::Phase::failed) homing_failed_ = true;
}

// CiA 402-2, table of bits 10, 12 and 13 in homing mode; bit 15 where an object begins it.
std::uint16_t DriveMotion::homingBits() const {
  if (homesByObject()) return homing_attained_ ? 0x8000 : 0;
  std::uint16_t bits = 0;
  const bool searching = homing_.phase() == HomingSequence::Phase::searching && !halted_;
  const bool at_rest = standing() && !homing_returning_;
  const bool tells = !definition_.quirks.homing_reaches_no_target;
  if (!searching && at_rest && tells) bits |= 0x0400;
  if (homing_attained_) bits |= 0x1000;
  if (homing_failed_) bits |= 0x2000;
  return bits;
}

}  // namespace cia402::sim
