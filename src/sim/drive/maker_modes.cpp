// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/maker_modes.h"

#include <algorithm>
#include <cmath>

namespace cia402::sim {
namespace {

constexpr std::int64_t kSteps = 1, kSpeed = 2;  // role maker_mode
constexpr std::int64_t kByPulseWidth = 3;       // role maker_speed_source
constexpr double kRampSpeed = 1000.0 / 60.0;    // turns/s, reached in the time of a ramp

}  // namespace

std::int64_t MakerModes::number() const {
  return running_ != 0 ? running_ : axis_.values.raw(Role::maker_mode, 0);
}

void MakerModes::setDuty(double duty) {
  duty_ = duty;
  axis_.values.setRaw(Role::pulse_width, std::llround(100.0 * std::fabs(duty)));
}

void MakerModes::begin(bool on) {
  running_ = on ? number() : 0;
  target_ = axis_.demand.position;
}

void MakerModes::trigger() {
  if (running_ == kSteps) target_ += axis_.values.get(Role::step_amount, 0.0);
}

void MakerModes::step() { running_ == kSteps ? stepDistance() : stepSpeed(); }

/// At its speed at once, without a ramp.
void MakerModes::stepDistance() {
  Demand& demand = axis_.demand;
  const double speed = paused_ ? 0.0 : std::fabs(axis_.values.get(Role::step_speed, 0.0));
  const double change = speed * kDriveStepS;
  const double next = std::clamp(target_, demand.position - change, demand.position + change);
  demand.velocity = (next - demand.position) / kDriveStepS;
  demand.position = next;
  axis_.motor.followPosition(demand.position);
}

void MakerModes::stepSpeed() {
  Demand& demand = axis_.demand;
  const bool by_width = axis_.values.raw(Role::maker_speed_source, 0) == kByPulseWidth;
  const double wanted = by_width ? duty_ * axis_.definition.own.full_pulse_width
                                 : axis_.values.get(Role::maker_speed, 0.0);
  const auto ramp = [this](Role time) {
    const double seconds = static_cast<double>(axis_.values.raw(time, 0)) * 1e-3;
    return seconds > 0.0 ? kRampSpeed / seconds : kUnlimited;
  };
  const bool chosen = running_ == kSpeed && !paused_;
  demand.velocity =
      rampVelocity(demand.velocity, chosen ? wanted : 0.0, ramp(Role::maker_acceleration_time),
                   ramp(Role::maker_deceleration_time));
  axis_.motor.followVelocity(demand.velocity);
  demand.position = axis_.motor.position();
}

}  // namespace cia402::sim
