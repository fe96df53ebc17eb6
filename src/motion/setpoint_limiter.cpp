// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/setpoint_limiter.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cia402::motion {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Close to a limit the velocity is proportional to the room left, room / delay. A loop of that
/// gain closed over feedback that is late by `reaction` comes in without overshoot only while gain
/// * reaction < 1/e, hence a delay of at least e times the reaction.
constexpr double kSettling = 3;

/// The largest velocity towards a place `room` ahead from which one can still stop there: moving on
/// for `delay_s` and then braking with `deceleration` takes v·delay + v²/(2·deceleration). Braking
/// in steps needs no more than braking continuously, hence this holds whatever steps follow.
double brakingVelocity(double room, double delay_s, double deceleration) {
  if (!(room > 0)) return 0;  // also if the position is unknown
  return 2 * room / (delay_s + std::sqrt(delay_s * delay_s + 2 * room / deceleration));
}

/// Rounding alone must not carry a position over a limit that braking kept.
double withoutRounding(double to, double from, const JointLimits& limits) {
  const auto barely = [to](double limit) {
    return std::abs(to - limit) < 1e-9 * (1 + std::abs(to));
  };
  if (limits.upper && from <= *limits.upper && to > *limits.upper && barely(*limits.upper)) {
    return *limits.upper;
  }
  if (limits.lower && from >= *limits.lower && to < *limits.lower && barely(*limits.lower)) {
    return *limits.lower;
  }
  return to;
}

}  // namespace

void SetpointLimiter::resetTo(const MotionState& state, Time now) {
  output_ = state;
  if (!std::isfinite(state.velocity)) output_.velocity = 0;
  command_.reset();
  stepped_ = now;
  smooth_.reset();
  if (joint_.limits.jerk) smooth_.emplace(joint_.limits);
}

Result<void> SetpointLimiter::take(double command, const char* power) {
  if (!std::isfinite(command)) {
    return Error{joint_.name + ": the commanded value is " + formatNumber(command) + " " +
                 toString(joint_.unit) + power + ", not a finite number; it is ignored"};
  }
  command_ = command;
  return {};
}

double SetpointLimiter::stoppable(double desired, double position, double delay_s,
                                  double margin) const {
  const JointLimits& limits = joint_.limits;
  const double acceleration = limits.acceleration.value_or(kInfinity);
  const double fastest = limits.velocity.value_or(kInfinity);
  double lowest = -fastest, highest = fastest;
  if (limits.upper) {
    const double room = *limits.upper - margin - position;
    highest = std::min(highest, brakingVelocity(room, delay_s, acceleration));
  }
  if (limits.lower) {
    const double room = position - *limits.lower - margin;
    lowest = std::max(lowest, -brakingVelocity(room, delay_s, acceleration));
  }
  return std::clamp(desired, lowest, highest);
}

double SetpointLimiter::permitted(double desired, double position, double dt,
                                  double reaction_s) const {
  const double change = joint_.limits.acceleration.value_or(kInfinity) * dt;
  return std::clamp(stoppable(desired, position, dt + kSettling * reaction_s, 0),
                    output_.velocity - change, output_.velocity + change);
}

double SetpointLimiter::slower(double dt) const {
  const double deceleration = joint_.limits.acceleration.value_or(kInfinity);
  const double speed = std::max(0.0, std::abs(output_.velocity) - deceleration * dt);
  return std::copysign(speed, output_.velocity);
}

void PositionLimiter::reset(const MotionState& commanded, Time now) {
  resetTo(commanded, now);
  previous_command_ = commanded.position;
  fresh_ = met_ = false;
}

Result<void> PositionLimiter::command(double position) {
  if (Result<void> taken = take(position, ""); !taken) return taken;
  command_ = withinReach(joint_.limits, *command_, output_.position);
  fresh_ = true;
  return {};
}

double PositionLimiter::streamVelocity(double dt) const {
  if (!fresh_ || !previous_command_) return 0;
  const double fastest = joint_.limits.velocity.value_or(kInfinity);
  return std::clamp((*command_ - *previous_command_) / dt, -fastest, fastest);
}

/// Towards the command, in one step at most onto it, and never faster than from where its own
/// velocity can still be met by braking.
double PositionLimiter::approach(double dt) const {
  const double acceleration = joint_.limits.acceleration.value_or(kInfinity);
  const double way = *command_ - output_.position;
  const double moving = streamVelocity(dt);
  const double relative = brakingVelocity(std::abs(way), dt, acceleration);
  return way >= 0 ? std::min(way / dt, moving + relative) : std::max(way / dt, moving - relative);
}

/// Who comes back from beyond a limit does not turn: what lies outside of where it can stop is out
/// of reach.
double PositionLimiter::outermost() const {
  const double at = output_.position;
  const JointLimits& limits = joint_.limits;
  if (limits.upper && at > *limits.upper) return std::min(at, smooth_->restsAt());
  if (limits.lower && at < *limits.lower) return std::max(at, smooth_->restsAt());
  return at;
}

/// What was followed and comes no more is brought to rest ahead; see step().
void PositionLimiter::stepSmoothly(double dt) {
  const double from = output_.position;
  smooth_->reset(output_);
  if (command_ && (fresh_ || !met_)) {
    const double told = *command_;
    command_ = withinReach(joint_.limits, told, outermost());
    const double moving = *command_ == told ? streamVelocity(dt) : 0;
    met_ = smooth_->approach(*command_, moving, dt) && moving != 0;
  } else {
    smooth_->brake(dt);
    if (command_) command_ = smooth_->state().position;
  }
  output_ = smooth_->state();
  output_.position = withoutRounding(output_.position, from, joint_.limits);
}

MotionState PositionLimiter::step(Time now) {
  const double dt = toSeconds(now - stepped_);
  if (!(dt > 0)) return output_;
  if (smooth_) {
    stepSmoothly(dt);
    previous_command_ = output_.position;
    if (command_) previous_command_ = fresh_ ? command_ : std::nullopt;
    fresh_ = false;
    stepped_ = now;
    return output_;
  }
  const bool follow = command_.has_value();
  const JointLimits& limits = joint_.limits;
  const double from = output_.position;
  // Without a limit of acceleration the next step is at rest, at the command.
  const bool ended =
      follow && met_ && !fresh_ && output_.velocity != 0 && limits.acceleration.has_value();
  const double wanted = follow && !ended ? approach(dt) : slower(dt);
  const double velocity = permitted(wanted, from, dt, 0);
  const double to = withoutRounding(from + velocity * dt, from, limits);
  if (ended) command_ = to;
  output_ = {to, velocity, (velocity - output_.velocity) / dt};
  met_ = follow && std::abs(to - *command_) <= 1e-12 * (1 + std::abs(to));
  previous_command_ = to;
  if (command_) previous_command_ = fresh_ ? command_ : std::nullopt;
  fresh_ = false;
  stepped_ = now;
  return output_;
}

void VelocityLimiter::reset(const MotionState& commanded, Time now) { resetTo(commanded, now); }

Result<void> VelocityLimiter::command(double velocity) { return take(velocity, "/s"); }

MotionState VelocityLimiter::step(Time now, double position) {
  const double dt = toSeconds(now - stepped_);
  if (!(dt > 0)) return output_;
  const JointLimits& limits = joint_.limits;
  const bool lost = std::isnan(position) && (limits.lower || limits.upper);
  const bool follow = command_.has_value() && !lost;
  stepped_ = now;
  if (smooth_) {
    smooth_->reset({position, output_.velocity, output_.acceleration});
    if (follow) {
      // Its jerk takes so long to brake it, and so far, and a half more, it may be ahead: see
      // unseen().
      const double jerk = *joint_.limits.jerk;
      const double delay_s = dt + kSettling * reaction_s_ + limits.acceleration.value_or(0) / jerk;
      const double margin = jerk * reaction_s_ * reaction_s_ * reaction_s_ / 4;
      smooth_->turn(stoppable(*command_, position, delay_s, margin), dt, reaction_s_);
    } else {
      smooth_->brake(dt);
    }
    return output_ = {position, smooth_->state().velocity, smooth_->state().acceleration};
  }
  const double desired = follow ? *command_ : slower(dt);
  const double velocity = permitted(desired, position, dt, reaction_s_);
  output_ = {position, velocity, (velocity - output_.velocity) / dt};
  return output_;
}

}  // namespace cia402::motion
