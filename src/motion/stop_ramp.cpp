// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/motion/stop_ramp.h"

#include <algorithm>
#include <cmath>

namespace cia402::motion {

namespace {

constexpr double kLongest_s = 1e9;  // keeps the end representable in nanoseconds

MotionState advance(const MotionState& from, double jerk, double t) {
  return {from.position + t * (from.velocity + t * (from.acceleration / 2 + t * jerk / 6)),
          from.velocity + t * (from.acceleration + t * jerk / 2), from.acceleration + t * jerk};
}

Error notAboveZero(const Joint& joint, const char* what, double value, const char* power) {
  return {joint.name + ": the stop ramp's " + what + " is " + formatNumber(value) + " " +
          toString(joint.unit) + power + "; it must be a finite number above 0"};
}

bool isUsable(double limit) { return std::isfinite(limit) && limit > 0; }

}  // namespace

Result<StopLimits> stopLimits(const Joint& joint, double deceleration, std::optional<double> jerk) {
  if (!isUsable(deceleration)) return notAboveZero(joint, "deceleration", deceleration, "/s²");
  if (jerk && !isUsable(*jerk)) return notAboveZero(joint, "jerk", *jerk, "/s³");
  return StopLimits{deceleration, jerk, joint.limits.lower, joint.limits.upper,
                    joint.limits.acceleration};
}

StopRamp::StopRamp(const MotionState& state, const StopLimits& limits, Time start)
    : start_(start), end_(start), stop_position_(state.position) {
  const bool is_finite = std::isfinite(state.position) && std::isfinite(state.velocity) &&
                         std::isfinite(state.acceleration);
  if (!is_finite || !isUsable(limits.deceleration)) return;
  if (limits.jerk && isUsable(*limits.jerk)) {
    planWithJerk(state, limits.deceleration, *limits.jerk);
  } else {
    plan(state, limits.deceleration);
  }
  keepWithin(state, limits);
  end_ = start + fromSeconds(std::min(duration_s_, kLongest_s));
}

void StopRamp::append(const MotionState& begin, double duration_s, double jerk) {
  phases_[count_++] = {duration_s, jerk, begin};
  duration_s_ += duration_s;
  stop_position_ = advance(begin, jerk, duration_s).position;
}

void StopRamp::plan(const MotionState& state, double deceleration) {
  count_ = 0;
  duration_s_ = 0;
  const double acceleration = -std::copysign(deceleration, state.velocity);
  append({state.position, state.velocity, acceleration}, std::abs(state.velocity) / deceleration,
         0);
}

// If the acceleration were taken back to zero at once, the velocity v + a|a|/(2j) would remain; the
// ramp works against its sign. Mirrored so that this is positive: acceleration falls from a to
// -peak, stays, and returns to zero. Without the middle phase the peak follows from
// v + (a² - peak²)/(2j) - peak²/(2j) = 0.
void StopRamp::planWithJerk(const MotionState& state, double deceleration, double jerk) {
  const double remaining =
      state.velocity + state.acceleration * std::abs(state.acceleration) / (2 * jerk);
  const double sign = std::copysign(1.0, remaining);
  const double v = sign * state.velocity, a = sign * state.acceleration;
  const double peak = std::min(deceleration, std::sqrt(std::max(0.0, jerk * v + a * a / 2)));
  const bool too_steep = a < -peak;  // decelerates more than allowed: ease off first
  const double first_jerk = too_steep ? jerk : -jerk;
  const double first = std::abs(a + peak) / jerk;
  const double after_first = v + first * (a - peak) / 2;
  const double hold =
      peak > 0 ? std::max(0.0, (after_first - peak * peak / (2 * jerk)) / peak) : 0.0;

  append(state, first, sign * first_jerk);
  append(advance(phases_[0].begin, phases_[0].jerk, first), hold, 0);
  append(advance(phases_[1].begin, 0, hold), peak / jerk, sign * jerk);
}

void StopRamp::keepWithin(const MotionState& state, const StopLimits& limits) {
  const bool beyond_upper =
      limits.upper && state.position <= *limits.upper && stop_position_ > *limits.upper;
  const bool beyond_lower =
      limits.lower && state.position >= *limits.lower && stop_position_ < *limits.lower;
  if (!beyond_upper && !beyond_lower) return;
  const double room =
      beyond_upper ? *limits.upper - state.position : state.position - *limits.lower;
  const double towards = beyond_upper ? state.velocity : -state.velocity;
  const double needed = towards > 0 ? towards * towards / (2 * room) : 0.0;
  const double hardest = std::max(limits.deceleration, limits.hardest.value_or(0));
  plan(state, std::clamp(needed, limits.deceleration, hardest));
}

MotionState StopRamp::sample(Time time) const {
  if (time >= end_ || count_ == 0) return {stop_position_, 0, 0};
  double t = std::max(0.0, toSeconds(time - start_));
  std::size_t i = 0;
  while (i + 1 < count_ && t > phases_[i].duration_s) t -= phases_[i++].duration_s;
  return advance(phases_[i].begin, phases_[i].jerk, std::min(t, phases_[i].duration_s));
}

GroupStop::GroupStop(std::vector<StopLimits> limits)
    : limits_(std::move(limits)), ramps_(limits_.size()) {}

void GroupStop::start(const std::vector<MotionState>& states, Time time) {
  for (std::size_t i = 0; i < ramps_.size(); ++i) {
    ramps_[i] = StopRamp(i < states.size() ? states[i] : MotionState{}, limits_[i], time);
  }
}

void GroupStop::sample(Time time, std::vector<MotionState>& states) const {
  const std::size_t count = std::min(states.size(), ramps_.size());
  for (std::size_t i = 0; i < count; ++i) states[i] = ramps_[i].sample(time);
}

Time GroupStop::endTime() const {
  Time end{};
  for (const StopRamp& ramp : ramps_) end = std::max(end, ramp.endTime());
  return end;
}

}  // namespace cia402::motion
