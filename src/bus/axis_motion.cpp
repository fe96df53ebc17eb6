// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/axis_motion.h"

#include <algorithm>
#include <cmath>

namespace cia402::bus {
namespace {

constexpr double kDefaultDeceleration = 5.0;        // rad/s²
constexpr double kDefaultLinearDeceleration = 0.5;  // m/s²

motion::LimiterConfig limiterConfig(const drive::AxisConfig& config) {
  motion::LimiterConfig limiter;
  limiter.joint = jointOf(config);
  limiter.stop_deceleration = stopDeceleration(config);
  return limiter;
}

motion::LimiterConfig velocityLimiterConfig(const drive::AxisConfig& config) {
  motion::LimiterConfig limiter = limiterConfig(config);
  limiter.command_timeout = config.command_timeout;
  // A velocity always has a ramp: a step in the set-point would be a jerk of the machine.
  if (!limiter.joint.limits.acceleration) {
    limiter.joint.limits.acceleration = stopDeceleration(config);
  }
  return limiter;
}

}  // namespace

motion::Joint jointOf(const drive::AxisConfig& config) {
  motion::Joint joint;
  joint.name = config.joint;
  joint.limits.lower = config.limits.lower;
  joint.limits.upper = config.limits.upper;
  joint.limits.velocity = config.limits.velocity;
  joint.limits.acceleration = config.limits.acceleration;
  joint.limits.jerk = config.limits.jerk;
  joint.limits.effort = config.limits.effort;
  joint.limits.continuous = config.geometry.type == drive::AxisGeometry::Type::continuous;
  joint.unit = config.geometry.type == drive::AxisGeometry::Type::prismatic
                   ? motion::JointUnit::metre
                   : motion::JointUnit::radian;
  return joint;
}

double stopDeceleration(const drive::AxisConfig& config) {
  if (config.limits.acceleration) return *config.limits.acceleration;
  return config.geometry.type == drive::AxisGeometry::Type::prismatic ? kDefaultLinearDeceleration
                                                                      : kDefaultDeceleration;
}

motion::StopLimits stopLimits(const drive::AxisConfig& config) {
  motion::StopLimits limits;
  limits.deceleration = stopDeceleration(config);
  limits.lower = config.limits.lower;
  limits.upper = config.limits.upper;
  limits.hardest = config.limits.acceleration;
  return limits;
}

// The drive acts on a set-point up to two cycles after it was computed from a measured position.
AxisMotion::AxisMotion(const drive::AxisConfig& config, Duration cycle)
    : position_(limiterConfig(config)),
      velocity_(velocityLimiterConfig(config), 2 * cycle),
      cycle_(cycle),
      timeout_(config.command_timeout),
      effort_limit_(config.limits.effort) {}

Result<void> AxisMotion::command(const drive::Axis& axis, double value, Time now) {
  const std::string refusal = axis.motionRefusal();
  if (!refusal.empty()) return Error{refusal};
  if (owner_ != nullptr) {
    return Error{axis.config().name +
                 ": set-point refused: the axis follows a trajectory of group " + *owner_ +
                 "; stop that first with an empty trajectory"};
  }
  if (!std::isfinite(value)) {
    return Error{axis.config().name + ": set-point refused: it is not a finite number"};
  }
  if (!entered(axis)) enter(axis, now);
  if (mode_->kind == drive::ControlKind::homing) {
    return Error{axis.config().name + ": set-point refused: mode " + mode_->name +
                 " takes none; set_mode another first"};
  }
  if (ramp_) {
    position_.reset(ramp_->sample(now), now);
    ramp_.reset();
  }
  command_ = value;
  commanded_ = now;
  if (mode_->kind == drive::ControlKind::velocity) return velocity_.command(value, now);
  if (mode_->kind != drive::ControlKind::position) return {};
  const drive::AxisLimits& limits = axis.config().limits;
  if (limits.lower) command_ = std::max(*command_, *limits.lower);
  if (limits.upper) command_ = std::min(*command_, *limits.upper);
  return position_.command(*command_, now);
}

bool AxisMotion::entered(const drive::Axis& axis) const {
  return mode_ == axis.state().mode && zero_changes_ == axis.state().zero_changes;
}

void AxisMotion::enter(const drive::Axis& axis, Time now) {
  mode_ = axis.state().mode;
  zero_changes_ = axis.state().zero_changes;
  command_.reset();
  ramp_.reset();
  at_rest_ = true;
  rest(axis, now);
}

void AxisMotion::rest(const drive::Axis& axis, Time now) {
  stepped_ = now;
  position_.reset({axis.target(), 0.0, 0.0}, now);
  velocity_.reset({axis.state().position, 0.0, 0.0}, now);
}

// The limiters would make good in one step whatever the time since the last one allows. A drive
// that got no new positions has come to rest meanwhile.
void AxisMotion::forgetLateCycles(const drive::Axis& axis, Time now) {
  if (now - stepped_ <= 2 * cycle_) return;
  position_.reset({axis.target(), 0.0, 0.0}, now - cycle_);
  velocity_.reset({axis.state().position, velocity_.output().velocity, 0.0}, now - cycle_);
  if (mode_->kind == drive::ControlKind::position) (void)position_.command(*command_, now);
  if (mode_->kind == drive::ControlKind::velocity) (void)velocity_.command(*command_, commanded_);
}

void AxisMotion::stop(const drive::Axis& axis, Time now) {
  if (mode_ == nullptr || owner_ != nullptr || !command_) return;
  if (mode_->kind == drive::ControlKind::velocity) {
    // Refusal is impossible: zero is finite.
    (void)velocity_.command(0.0, now);
  } else if (mode_->kind == drive::ControlKind::position && mode_->cyclic) {
    if (!ramp_ && !at_rest_) ramp_.emplace(position_.output(), stopLimits(axis.config()), stepped_);
  } else if (mode_->kind == drive::ControlKind::position) {
    command_.reset();  // the drive plans its motion: who disables it stops it by quick stop
    at_rest_ = true;
  } else {
    command_ = 0.0;
  }
}

void AxisMotion::step(drive::Axis& axis, Time now) {
  if (!axis.state().ready_for_motion || axis.state().mode == nullptr) {
    mode_ = nullptr;
    command_.reset();
    at_rest_ = true;
    return;
  }
  if (owner_ != nullptr) {
    mode_ = nullptr;  // what the group does to the target is not known here
    return;
  }
  if (!entered(axis)) enter(axis, now);
  if (!command_) {
    rest(axis, now);
    return;
  }
  forgetLateCycles(axis, now);
  stepped_ = now;
  switch (mode_->kind) {
    case drive::ControlKind::position:
      stepPosition(axis, now);
      break;
    case drive::ControlKind::velocity:
      stepVelocity(axis, now);
      break;
    case drive::ControlKind::torque:
      stepTorque(axis, now);
      break;
    case drive::ControlKind::homing:
      break;
  }
}

void AxisMotion::stepPosition(drive::Axis& axis, Time now) {
  if (!mode_->cyclic) {  // the drive makes its own profile
    if (axis.target() != *command_ && !axis.setTarget(*command_)) command_.reset();
    at_rest_ = axis.state().target_reached;
    return;
  }
  const motion::MotionState state = ramp_ ? ramp_->sample(now) : position_.step(now);
  at_rest_ = state.velocity == 0.0;
  if (!axis.setTarget(state.position)) command_.reset();
}

void AxisMotion::stepVelocity(drive::Axis& axis, Time now) {
  const motion::MotionState state = velocity_.step(now, axis.state().position);
  at_rest_ = state.velocity == 0.0;
  if (!axis.setTarget(state.velocity)) zero(axis, now);
}

void AxisMotion::stepTorque(drive::Axis& axis, Time now) {
  double effort = now - commanded_ > timeout_ ? 0.0 : *command_;
  if (effort_limit_) effort = std::clamp(effort, -*effort_limit_, *effort_limit_);
  at_rest_ = effort == 0.0;
  if (!axis.setTarget(effort)) zero(axis, now);
}

void AxisMotion::zero(drive::Axis& axis, Time now) {
  command_.reset();
  at_rest_ = true;
  velocity_.reset({axis.state().position, 0.0, 0.0}, now);
  (void)axis.setTarget(0.0);  // fits every object and limit
}

}  // namespace cia402::bus
