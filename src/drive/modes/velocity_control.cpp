// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/velocity_control.h"

#include <cmath>

namespace cia402::drive {
namespace {

/// A velocity always has a ramp: a step in the set-point would be a jerk of the machine.
motion::JointLimits withRamp(const AxisConfig& config) {
  motion::JointLimits limits = limitsOf(config);
  if (!limits.acceleration) limits.acceleration = stopDeceleration(config);
  return limits;
}

}  // namespace

// The drive acts on a set-point up to two cycles after it was computed from a measured position.
VelocityControl::VelocityControl(const ModeChannel& channel, const Context& context)
    : ModeControl(channel, context),
      limiter_(jointOf(context.axis.config), kReactionCycles * context.axis.config.cycle) {}

void VelocityControl::beginStream(const Stream& stream, Time at) {
  limiter_.limitTo(withRamp(axis().config));
  limiter_.reset({state().position, sent().velocity(), 0.0}, at);
  if (stream.command) (void)limiter_.command(*stream.command);  // finite, so it is taken
}

void VelocityControl::takeCommand(Stream& stream) { (void)limiter_.command(*stream.command); }

std::optional<double> VelocityControl::follow(Stream& stream, Time now) {
  if (now - stream.commanded > axis().config.command_timeout) {
    stream.dried_up = *stream.command != 0.0;
    (void)limiter_.command(0.0);
  }
  const motion::MotionState state = limiter_.step(stream.clock, this->state().position);
  stream.at_rest = state.velocity == 0.0;
  return state.velocity;
}

bool VelocityControl::accepts(double value) const {
  return !(limits().velocity && std::fabs(value) > *limits().velocity) && leadsInside(value);
}

}  // namespace cia402::drive
