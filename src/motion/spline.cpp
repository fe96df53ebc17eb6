// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/spline.h"

#include <algorithm>
#include <cmath>

namespace cia402::motion {

SplineSegment::SplineSegment(const Polynomial& position, double duration_s)
    : position_(position),
      velocity_(position.derivative()),
      acceleration_(velocity_.derivative()),
      duration_s_(duration_s) {}

SplineSegment SplineSegment::linear(double from, double to, double duration_s) {
  return {Polynomial{{from, to - from}}, duration_s};
}

SplineSegment SplineSegment::cubic(const MotionState& from, const MotionState& to,
                                   double duration_s) {
  const double way = to.position - from.position;
  const double v0 = from.velocity * duration_s, v1 = to.velocity * duration_s;
  return {Polynomial{{from.position, v0, 3 * way - 2 * v0 - v1, -2 * way + v0 + v1}}, duration_s};
}

SplineSegment SplineSegment::quintic(const MotionState& from, const MotionState& to,
                                     double duration_s) {
  const double way = to.position - from.position;
  const double v0 = from.velocity * duration_s, v1 = to.velocity * duration_s;
  const double a0 = from.acceleration * duration_s * duration_s;
  const double a1 = to.acceleration * duration_s * duration_s;
  const double c3 = 10 * way - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1;
  const double c4 = -15 * way + 8 * v0 + 7 * v1 + 1.5 * a0 - a1;
  const double c5 = 6 * way - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1;
  return {Polynomial{{from.position, v0, 0.5 * a0, c3, c4, c5}}, duration_s};
}

MotionState SplineSegment::sample(double t_s) const {
  const double x = share(t_s);
  return {position_(x), velocity_(x) / duration_s_, acceleration_(x) / (duration_s_ * duration_s_)};
}

Range SplineSegment::range(const Polynomial& polynomial, double scale) const {
  const Extremum begin{polynomial(0) * scale, 0}, end{polynomial(1) * scale, duration_s_};
  Range result{begin, begin};
  const auto include = [&result](const Extremum& candidate) {
    if (candidate.value < result.min.value) result.min = candidate;
    if (candidate.value > result.max.value) result.max = candidate;
  };
  include(end);
  const Roots turning = rootsInUnitInterval(polynomial.derivative());
  for (std::size_t i = 0; i < turning.count; ++i) {
    include({polynomial(turning.x[i]) * scale, turning.x[i] * duration_s_});
  }
  return result;
}

bool SplineSegment::surelyWithin(const JointLimits& limits) const {
  const auto within = [](const Polynomial& polynomial, double scale, std::optional<double> low,
                         std::optional<double> high) {
    if (!low && !high) return true;
    const Bounds bounds = boundsInUnitInterval(polynomial);
    return (!low || bounds.min * scale >= *low) && (!high || bounds.max * scale <= *high);
  };
  const auto below = [&within](const Polynomial& polynomial, double scale,
                               const std::optional<double>& limit) {
    return !limit || within(polynomial, scale, -*limit, limit);
  };
  return within(position_, 1, limits.lower, limits.upper) &&
         below(velocity_, 1 / duration_s_, limits.velocity) &&
         below(acceleration_, 1 / (duration_s_ * duration_s_), limits.acceleration);
}

Range SplineSegment::positionRange() const { return range(position_, 1); }
Range SplineSegment::velocityRange() const { return range(velocity_, 1 / duration_s_); }
Range SplineSegment::accelerationRange() const {
  return range(acceleration_, 1 / (duration_s_ * duration_s_));
}

bool SplineSegment::isFinite() const {
  const auto finite = [](double value) { return std::isfinite(value); };
  const double rate = 1 / duration_s_;
  return std::isfinite(rate * rate) &&
         std::all_of(position_.c.begin(), position_.c.end(), finite) &&
         std::all_of(acceleration_.c.begin(), acceleration_.c.end(),
                     [rate](double value) { return std::isfinite(value * rate * rate); });
}

}  // namespace cia402::motion
