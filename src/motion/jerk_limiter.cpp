// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/jerk_limiter.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cia402::motion {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kStill = 1e-9;      // rad/s or m/s, of rounding
constexpr int kHalvings = 48;        // of the range of jerks
constexpr double kRounding = 1e-10;  // of places, in what they are large against

MotionState after(const MotionState& from, const JerkPiece& piece) {
  const double t = piece.time, j = piece.jerk;
  return {from.position + t * (from.velocity + t * (from.acceleration / 2 + t * j / 6)),
          from.velocity + t * (from.acceleration + t * j / 2), from.acceleration + t * j};
}

/// Between which values position and velocity are on a path.
struct Extent {
  double lowest, highest, slowest, fastest;

  explicit Extent(const MotionState& at)
      : lowest(at.position), highest(at.position), slowest(at.velocity), fastest(at.velocity) {}
  void take(const MotionState& at) {
    lowest = std::min(lowest, at.position);
    highest = std::max(highest, at.position);
    slowest = std::min(slowest, at.velocity);
    fastest = std::max(fastest, at.velocity);
  }
  /// A piece of the path, its beginning left out. @return its end
  MotionState take(const MotionState& from, const JerkPiece& piece) {
    const double v = from.velocity, a = from.acceleration, j = piece.jerk;
    const auto within = [&](double t) {
      if (t > 0 && t < piece.time) take(after(from, {t, j}));
    };
    if (j != 0) within(-a / j);  // where the velocity turns
    const double square = a * a - 2 * v * j;
    if (square >= 0) {  // where the position does
      const double q = -(a + std::copysign(std::sqrt(square), a));
      if (j != 0) within(q / j);
      if (q != 0) within(2 * v / q);
    }
    const MotionState end = after(from, piece);
    take(end);
    return end;
  }
};

/// Where a joint comes to rest, and what the way there extends over.
MotionState rest(const MotionState& from, double acceleration, double jerk, Extent* extent) {
  MotionState state = from;
  for (const JerkPiece& piece : brakingPieces(from, acceleration, jerk)) {
    state = extent != nullptr ? extent->take(state, piece) : after(state, piece);
  }
  return state;
}

/// The greatest number of a range that is not too great; its lower end where all are.
template <typename TooGreat>
double between(double low, double high, const TooGreat& too_great) {
  if (!too_great(high)) return high;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (too_great(middle) ? high : low) = middle;
  }
  return low;
}

}  // namespace

std::array<JerkPiece, 3> brakingPieces(const MotionState& from, double acceleration, double jerk) {
  const double v = from.velocity, a = from.acceleration;
  // The velocity once there is no acceleration any more tells to which side it is to brake.
  const double left = v + a * std::fabs(a) / (2 * jerk);
  if (left == 0) return {{{std::fabs(a) / jerk, -std::copysign(jerk, a)}, {0, 0}, {0, 0}}};
  const double sign = std::copysign(1.0, left);
  const double speed = sign * v, rise = sign * a;  // mirrored: it brakes downwards
  double peak = std::sqrt(std::max(0.0, jerk * speed + rise * rise / 2));
  double hold = 0;
  if (peak > acceleration) {
    peak = acceleration;
    hold = std::max(0.0, (speed + (rise * rise / 2 - peak * peak) / jerk) / peak);
  }
  return {
      {{std::max(0.0, (rise + peak) / jerk), -sign * jerk}, {hold, 0}, {peak / jerk, sign * jerk}}};
}

JerkLimiter::JerkLimiter(const JointLimits& limits)
    : lower_(limits.lower.value_or(-kUnlimited)),
      upper_(limits.upper.value_or(kUnlimited)),
      velocity_(limits.velocity.value_or(kUnlimited)),
      acceleration_(limits.acceleration.value_or(kUnlimited)),
      jerk_(limits.jerk.value_or(kUnlimited)) {}

double JerkLimiter::unseen(double velocity, double reaction_s) const {
  const double faster = std::fabs(state_.acceleration) / 2 + jerk_ * reaction_s / 6;
  return reaction_s * (velocity + reaction_s * faster);
}

// Who is at a limit, or beyond it, may not go further, but back.

bool JerkLimiter::tooHigh(double jerk, double dt, double reaction_s) const {
  const double ahead = unseen(std::max(0.0, state_.velocity), reaction_s);
  const double place = state_.position + ahead;
  Extent extent(state_);
  rest(extent.take(state_, {dt, jerk}), acceleration_, jerk_, &extent);
  return extent.highest + ahead > std::max(upper_, place) ||
         extent.fastest > std::max(place < upper_ ? velocity_ : kStill, state_.velocity);
}

bool JerkLimiter::tooLow(double jerk, double dt, double reaction_s) const {
  const double ahead = unseen(std::max(0.0, -state_.velocity), reaction_s);
  const double place = state_.position - ahead;
  Extent extent(state_);
  rest(extent.take(state_, {dt, jerk}), acceleration_, jerk_, &extent);
  return extent.lowest - ahead < std::min(lower_, place) ||
         extent.slowest < std::min(place > lower_ ? -velocity_ : -kStill, state_.velocity);
}

double JerkLimiter::restsAt() const { return rest(state_, acceleration_, jerk_, nullptr).position; }

void JerkLimiter::brake(double dt) {
  double left = dt;
  for (JerkPiece piece : brakingPieces(state_, acceleration_, jerk_)) {
    piece.time = std::min(piece.time, left);
    left -= piece.time;
    state_ = after(state_, piece);
  }
  if (left > 0) state_.velocity = state_.acceleration = 0;  // but for rounding it is so
}

template <typename Error>
bool JerkLimiter::goOn(const Error& error, double dt, double reaction_s) {
  const double a = state_.acceleration;
  const double lowest = std::clamp((-acceleration_ - a) / dt, -jerk_, jerk_);
  const double highest = std::clamp((acceleration_ - a) / dt, -jerk_, jerk_);
  const auto wrong = [&](double jerk) { return error(after(state_, {dt, jerk})); };
  const auto high = [&](double jerk) { return tooHigh(jerk, dt, reaction_s); };
  const auto low = [&](double jerk) { return tooLow(jerk, dt, reaction_s); };
  bool free = wrong(lowest) <= 0 && wrong(highest) >= 0;
  double jerk = between(lowest, highest, [&](double any) { return wrong(any) > 0; });
  if (high(jerk)) {
    free = false;
    jerk = between(lowest, jerk, high);
  } else if (low(jerk)) {
    free = false;
    jerk = -between(-highest, -jerk, [&](double any) { return low(-any); });
  }
  if (high(jerk) || low(jerk)) {
    brake(dt);
    return false;
  }
  state_ = after(state_, {dt, jerk});
  return free;
}

bool JerkLimiter::approach(double position, double velocity, double dt) {
  const auto relative = [&](const MotionState& state) {
    const MotionState moving{state.position - position, state.velocity - velocity,
                             state.acceleration};
    return rest(moving, acceleration_, jerk_, nullptr).position;
  };
  // On its last way to rest it stays: no jerk that is constant over a step would end there.
  const double near = kRounding * (1 + std::fabs(position));
  if (velocity == 0 && std::fabs(relative(state_)) <= near) {
    brake(dt);
    return true;
  }
  return goOn(relative, dt, 0);
}

void JerkLimiter::turn(double velocity, double dt, double reaction_s) {
  if (velocity == 0) return brake(dt);
  const auto settles = [&](const MotionState& state) {
    const double a = state.acceleration;
    return state.velocity + a * std::fabs(a) / (2 * jerk_) - velocity;
  };
  goOn(settles, dt, reaction_s);
}

}  // namespace cia402::motion
