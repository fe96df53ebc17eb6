// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/set_point.h"

#include <algorithm>
#include <cmath>

namespace cia402::drive {
namespace {

/// What trajectories may exceed a limit by (motion::Trajectory), and rounding.
constexpr double kTolerance = 1.0 + 1e-6;
constexpr double kRounded = 1.0 + 1e-9;

}  // namespace

SetPoint::SetPoint(const motion::JointLimits& limits, double deceleration, Duration cycle)
    : cycle_s_(toSeconds(cycle)), cycle_(cycle) {
  adopt(limits, deceleration);
}

void SetPoint::adopt(const motion::JointLimits& limits, double deceleration) {
  limits_ = limits;
  deceleration_ = deceleration;
  furthest_ = limits.velocity ? *limits.velocity * cycle_s_ * kTolerance : 1e300;
}

void SetPoint::rest(SetPointKind kind, double value) {
  if (kind != kind_) goals_ = {value, value};
  kind_ = kind;
  value_ = value;
  velocity_ = 0.0;
  has_given_ = false;
  stopping_ = false;
  ++breaks_;
}

void SetPoint::arrest(double velocity) {
  rest(SetPointKind::velocity, velocity);
  beginStop();
}

void SetPoint::stop(Duration over) {
  has_given_ = false;
  if (atRest() || (stopping_ && over > Duration::zero())) return;
  if (!stopping_) ++breaks_;
  beginStop(over);
}

void SetPoint::beginStop(Duration over) {
  stopping_ = true;
  if (kind_ == SetPointKind::stream) beginRamp(ramp_, gentlest(over));
  if (kind_ == SetPointKind::velocity) ramp_.begin(0.0, value_, deceleration_);
}

/// What was sent shows the velocity in the middle of the last cycle. A trajectory that brakes as
/// hard as it may and ends at the limit is half a cycle slower by now: in front of a limit a ramp
/// goes on from there, and, where even that leads beyond it, a little harder.
void SetPoint::beginRamp(motion::StopRamp& ramp, double deceleration) const {
  double speed = std::abs(velocity_);
  const double ahead = motion::room(limits_, value_, velocity_);
  if (speed * speed > 2.0 * deceleration * ahead * kRounded) {
    speed = std::max(speed - 0.5 * deceleration * cycle_s_, 0.0);
    if (ahead > 0.0) deceleration = std::max(deceleration, speed * speed / (2.0 * ahead));
  }
  ramp.begin(value_, std::copysign(speed, velocity_), deceleration);
}

double SetPoint::gentlest(Duration over) const {
  if (over <= Duration::zero()) return deceleration_;
  const double ahead = std::abs(motion::room(limits_, value_, velocity_));
  const double in_front = velocity_ * velocity_ / (2.0 * std::max(ahead, 1e-9));
  return std::min(deceleration_, std::max(std::abs(velocity_) / toSeconds(over), in_front));
}

void SetPoint::interrupt() {
  if (kind_ != SetPointKind::stream || (velocity_ == 0.0 && !stopping_)) return;
  velocity_ = 0.0;
  stopping_ = false;
  ++interruptions_;
}

void SetPoint::overtake(double position, double velocity) {
  rest(SetPointKind::stream, position);
  velocity_ = velocity;
  beginStop();
}

void SetPoint::shift(double by) {
  goals_.lowest += by;
  goals_.highest += by;
  if (kind_ != SetPointKind::stream && kind_ != SetPointKind::goal) return;
  value_ += by;
  has_given_ = false;
  if (stopping_) ramp_.shift(by);
  ++breaks_;
}

bool SetPoint::advance(Time now) {
  const double before = value_;
  leased_ = has_given_;
  if (leased_) {
    stopping_ = false;
    follow();
    has_given_ = false;
  } else {
    if (!stopping_ && !atRest()) {
      ++breaks_;
      beginStop();
    }
    if (stopping_) advanceStop();
  }
  if (value_ == before || std::isnan(value_)) {
    if (!atRest()) moved_at_ = now;
    return false;
  }
  moved_at_ = now;
  return true;
}

void SetPoint::follow() {
  double next = given_;
  if (kind_ == SetPointKind::stream) {
    next = std::clamp(next, value_ - furthest_, value_ + furthest_);
    velocity_ = (next - value_) / cycle_s_;
  } else if (kind_ == SetPointKind::goal) {
    goals_.lowest = std::fmin(goals_.lowest, next);
    goals_.highest = std::fmax(goals_.highest, next);
  }
  value_ = next;
}

void SetPoint::advanceStop() {
  if (kind_ == SetPointKind::torque) {
    value_ = 0.0;
    stopping_ = false;
    return;
  }
  ramp_.advance(cycle_);
  if (kind_ == SetPointKind::velocity) {
    value_ = ramp_.velocity();
  } else {
    value_ = withinLimits(ramp_.position());
    velocity_ = ramp_.velocity();
  }
  stopping_ = !ramp_.finished();
}

bool SetPoint::atRest() const {
  switch (kind_) {
    case SetPointKind::none:
    case SetPointKind::goal:
      return true;
    case SetPointKind::stream:
      return velocity_ == 0.0;
    case SetPointKind::velocity:
    case SetPointKind::torque:
      return value_ == 0.0 || std::isnan(value_);
  }
  return true;
}

/// An axis that stands beyond a limit is just stopped.
double SetPoint::withinLimits(double position) const {
  return motion::withinReach(limits_, position, value_);
}

SetPoint::Motion SetPoint::expected(Duration ahead) const {
  if (kind_ != SetPointKind::stream || velocity_ == 0.0) return {value_, 0.0};
  motion::StopRamp ramp = ramp_;
  if (!stopping_) beginRamp(ramp, deceleration_);
  ramp.advance(ahead);
  return {withinLimits(ramp.position()), ramp.velocity()};
}

}  // namespace cia402::drive
