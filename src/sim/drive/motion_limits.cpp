// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/motion_limits.h"

#include <algorithm>
#include <cmath>

namespace cia402::sim {

/// A change of speed and the whole seconds that it takes (6048h, 6049h, 604Ah).
double MotionLimits::velocityModeRamp(Role speed, Role time) const {
  const auto seconds = static_cast<double>(values_.raw(time, 1));
  return seconds > 0.0 ? values_.get(speed, kUnlimited) / seconds : kUnlimited;
}

double MotionLimits::deceleration(Ramp ramp, const ModeDefinition* mode) const {
  return std::min(rampOf(ramp, mode), clamp());
}

double MotionLimits::cornerTime(const ProfileLimits& limits) const {
  if (values_.raw(Role::motion_profile_type, 0) != definition_.s_curve.number) return 0.0;
  if (definition_.s_curve.time > 0.0) return definition_.s_curve.time;
  return std::max(limits.acceleration / values_.get(Role::profile_jerk_1, kUnlimited),
                  limits.deceleration / values_.get(Role::profile_jerk_2, kUnlimited));
}

double MotionLimits::rampOf(Ramp ramp, const ModeDefinition* mode) const {
  const bool vl = mode != nullptr && mode->behaviour == ModeBehaviour::velocity;
  switch (ramp) {
    case Ramp::slow_down:
      if (definition_.ramps_of_mode && mode != nullptr && mode->behaviour == ModeBehaviour::homing)
        return values_.get(Role::homing_acceleration, kUnlimited);
      if (vl) return velocityModeRamp(Role::vl_deceleration_speed, Role::vl_deceleration_time);
      return values_.get(Role::profile_deceleration, kUnlimited);
    case Ramp::quick_stop:
      if (vl) return velocityModeRamp(Role::vl_quick_stop_speed, Role::vl_quick_stop_time);
      return values_.get(Role::quick_stop_deceleration, kUnlimited);
    case Ramp::limit:
    case Ramp::coast:
    case Ramp::dynamic_brake:
      break;
  }
  return most_deceleration_;
}

double MotionLimits::maxSpeed() const {
  return std::fabs(values_.get(Role::max_motor_speed, kUnlimited));
}

ProfileLimits MotionLimits::profile(const ModeDefinition* mode) const {
  ProfileLimits limits;
  if (mode != nullptr && mode->behaviour == ModeBehaviour::velocity) {
    limits.velocity = maxSpeed();
    limits.acceleration = std::min(
        clamp(), velocityModeRamp(Role::vl_acceleration_speed, Role::vl_acceleration_time));
    limits.deceleration = deceleration(Ramp::slow_down, mode);
    return limits;
  }
  const double speed = mode != nullptr && mode->velocity
                           ? std::fabs(values_.get(*mode->velocity, kUnlimited))
                           : kUnlimited;
  limits.velocity =
      std::min({speed, maxSpeed(), values_.get(Role::max_profile_velocity, kUnlimited)});
  limits.acceleration = std::min({values_.get(Role::profile_acceleration, kUnlimited),
                                  values_.get(Role::max_acceleration, kUnlimited), clamp()});
  limits.deceleration = std::min({values_.get(Role::profile_deceleration, kUnlimited),
                                  values_.get(Role::max_deceleration, kUnlimited), clamp()});
  return limits;
}

bool MotionLimits::positionsCount() const {
  const std::int64_t number = values_.raw(Role::position_limits_use, 0);
  const auto& uses = definition_.limit_uses;
  if (number < 0 || number >= static_cast<std::int64_t>(uses.size())) return true;
  const LimitUse use = uses[static_cast<std::size_t>(number)];
  return use == LimitUse::on || (use == LimitUse::homed && homed_);
}

/// Of 607Bh and 607Dh the one that counts, by the numbers of the drive.
MotionLimits::Span MotionLimits::software() const {
  const auto one = [this](Role limit, Role range) {
    const double first = values_.get(limit, 0.0);
    if (definition_.range_use == RangeUse::none) return first;
    const double other = values_.get(range, first);
    if (definition_.range_use == RangeUse::greater) return std::max(first, other);
    return std::fabs(other) > std::fabs(first) ? other : first;
  };
  return {one(Role::position_minimum, Role::position_range_minimum),
          one(Role::position_maximum, Role::position_range_maximum)};
}

std::optional<MotionLimits::Span> MotionLimits::positions() const {
  if (!values_.has(Role::position_minimum) || !positionsCount()) return std::nullopt;
  const Span span = software();
  const double all = values_.range(Role::position_minimum);
  const double most = all - all / std::ldexp(1.0, 31);
  if (span.low >= span.high || (all > 0.0 && span.high - span.low >= most)) return std::nullopt;
  return span;
}

bool MotionLimits::offsetOutside() const {
  if (!values_.has(Role::position_minimum)) return false;
  const Span span = software();
  const double offset = values_.get(Role::home_offset, 0.0);
  return offset < span.low || offset > span.high;
}

double MotionLimits::clamped(double turns) {
  const auto limits = positions();
  const double target = limits ? std::clamp(turns, limits->low, limits->high) : turns;
  if (target != turns) {
    active_ = position_hit_ = true;
    upwards_ = target < turns;
  }
  return target;
}

double MotionLimits::braked(double velocity, double turns, double braking) {
  const auto limits = positions();
  if (!limits || velocity == 0.0) return velocity;
  const double room = velocity > 0.0 ? limits->high - turns : turns - limits->low;
  const double reachable = room <= 0.0 ? 0.0 : std::sqrt(2.0 * braking * room);
  active_ = active_ || reachable < std::fabs(velocity);
  return std::copysign(std::min(std::fabs(velocity), reachable), velocity);
}

bool MotionLimits::blocked(double direction, double position) {
  const bool at_switch = (direction > 0.0 && switches_.positiveLimit(position)) ||
                         (direction < 0.0 && switches_.negativeLimit(position));
  active_ = active_ || at_switch;
  switch_hit_ = switch_hit_ || at_switch;
  if (at_switch) upwards_ = direction > 0.0;
  return at_switch;
}

}  // namespace cia402::sim
