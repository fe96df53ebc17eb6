// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/axis_motion.h"

#include <algorithm>
#include <cmath>

namespace cia402::bus {
namespace {

motion::LimiterConfig limiterConfig(const drive::AxisConfig& config) {
  motion::LimiterConfig limiter;
  limiter.joint = jointOf(config);
  return limiter;
}

motion::LimiterConfig velocityLimiterConfig(const drive::AxisConfig& config) {
  motion::LimiterConfig limiter = limiterConfig(config);
  // A velocity always has a ramp: a step in the set-point would be a jerk of the machine.
  if (!limiter.joint.limits.acceleration) {
    limiter.joint.limits.acceleration = drive::stopDeceleration(config);
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
    return Error{drive::jointName(axis.config()) +
                 ": set-point refused: the axis follows a trajectory of group " + *owner_ +
                 "; stop that first with an empty trajectory"};
  }
  if (!std::isfinite(value)) {
    return Error{drive::jointName(axis.config()) +
                 ": set-point refused: it is not a finite number"};
  }
  if (!entered(axis)) enter(axis);
  if (mode_->kind == drive::ControlKind::homing) {
    return Error{drive::jointName(axis.config()) + ": set-point refused: mode " + mode_->name +
                 " takes none; set_mode another first"};
  }
  if (!command_) resume(axis, clock_);
  command_ = value;
  commanded_ = now;
  dried_up_ = false;
  if (mode_->kind == drive::ControlKind::velocity) return velocity_.command(value, clock_);
  if (mode_->kind != drive::ControlKind::position) return {};
  if (!mode_->cyclic) {
    const drive::AxisLimits& limits = axis.config().limits;
    motion::JointLimits range;
    range.lower = limits.lower;
    range.upper = limits.upper;
    command_ = motion::withinReach(range, *command_, axis.state().position);
  }
  return position_.command(*command_, clock_);
}

bool AxisMotion::entered(const drive::Axis& axis) const {
  return mode_ == axis.state().mode && zero_changes_ == axis.state().zero_changes;
}

void AxisMotion::enter(const drive::Axis& axis) {
  mode_ = axis.state().mode;
  zero_changes_ = axis.state().zero_changes;
  command_.reset();
  dried_up_ = false;
}

void AxisMotion::resume(const drive::Axis& axis, Time at) {
  const drive::SetPoint& sent = axis.setPoint();
  breaks_ = sent.breaks();
  given_up_ = sent.givenUp();
  interruptions_ = sent.interruptions();
  position_.reset({sent.value(), sent.velocity(), 0.0}, at);
  velocity_.reset({axis.state().position, sent.velocity(), 0.0}, at);
  if (!command_) return;
  if (mode_->kind == drive::ControlKind::position) (void)position_.command(*command_, at);
  if (mode_->kind == drive::ControlKind::velocity) (void)velocity_.command(*command_, at);
}

void AxisMotion::stop(drive::Axis& axis) {
  if (owner_ != nullptr) return;
  command_.reset();
  axis.stopSetPoint();
}

void AxisMotion::step(drive::Axis& axis, Time now) {
  clock_ += cycle_;
  if (owner_ != nullptr) {
    command_.reset();
    dried_up_ = false;
    return;
  }
  const drive::SetPoint& sent = axis.setPoint();
  if (!axis.state().ready_for_motion || axis.state().mode == nullptr) {
    command_.reset();
    dried_up_ = false;
    at_rest_ = sent.atRest();
    return;
  }
  if (!entered(axis)) enter(axis);
  at_rest_ = sent.atRest();
  if (!command_) return;
  if (sent.breaks() != breaks_ || sent.interruptions() != interruptions_) {
    if (sent.givenUp() != given_up_) {
      command_.reset();
      return;
    }
    resume(axis, clock_ - cycle_);
  }
  switch (mode_->kind) {
    case drive::ControlKind::position:
      stepPosition(axis);
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

void AxisMotion::stepPosition(drive::Axis& axis) {
  if (!mode_->cyclic) {  // the drive makes its own profile
    if (axis.target() != *command_ && !axis.setTarget(*command_)) command_.reset();
    at_rest_ = axis.state().target_reached;
    return;
  }
  const motion::MotionState state = position_.step(clock_);
  at_rest_ = state.velocity == 0.0;
  command_ = position_.goal();
  if (!axis.setTarget(state.position)) command_.reset();
}

void AxisMotion::stepVelocity(drive::Axis& axis, Time now) {
  if (now - commanded_ > timeout_) {
    dried_up_ = *command_ != 0.0;
    (void)velocity_.command(0.0, clock_);  // cannot be refused: zero is finite
  }
  const motion::MotionState state = velocity_.step(clock_, axis.state().position);
  at_rest_ = state.velocity == 0.0;
  if (!axis.setTarget(state.velocity)) command_.reset();
}

void AxisMotion::stepTorque(drive::Axis& axis, Time now) {
  double effort = *command_;
  if (effort_limit_) effort = std::clamp(effort, -*effort_limit_, *effort_limit_);
  at_rest_ = effort == 0.0;
  const bool old = now - commanded_ > timeout_;
  dried_up_ = old && *command_ != 0.0;
  if (old || !axis.setTarget(effort)) command_.reset();
}

}  // namespace cia402::bus
