// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "motion/joint.h"
#include "motion/polynomial.h"

namespace cia402::motion {

/// A value and when it is taken, in seconds from the beginning of the segment.
struct Extremum {
  double value = 0, time_s = 0;
};

/// The smallest and the largest value over a segment, its ends included.
struct Range {
  Extremum min, max;

  /// The one of the two with the larger magnitude.
  const Extremum& largest() const { return -min.value > max.value ? min : max; }
};

/// Velocity and acceleration, per s and s².
struct SplineRates {
  double velocity, acceleration;
};

/// One joint's way between two points: a polynomial in time over [0, duration]. Kept in the
/// normalised time t / duration, which stays well-conditioned from nanoseconds to hours. A value;
/// nothing here allocates.
class SplineSegment {
 public:
  /// Constant velocity between two positions. Durations are in seconds and > 0, here and below.
  static SplineSegment linear(double from, double to, double duration_s);
  /// Meets positions and velocities at both ends; accelerations are ignored.
  static SplineSegment cubic(const MotionState& from, const MotionState& to, double duration_s);
  /// Meets positions, velocities and accelerations at both ends.
  static SplineSegment quintic(const MotionState& from, const MotionState& to, double duration_s);

  /// The state at `t_s` seconds from the beginning; outside [0, duration] that of the nearer end.
  MotionState sample(double t_s) const;
  /// The position of that alone.
  double position(double t_s) const { return position_(share(t_s)); }

  /// Velocity and acceleration of that alone.
  SplineRates rates(double t_s) const {
    const double x = share(t_s);
    return {velocity_(x) / duration_s_, acceleration_(x) / (duration_s_ * duration_s_)};
  }

  double duration() const { return duration_s_; }

  /// Exact extrema over the whole segment, found at the roots of the next derivative.
  Range positionRange() const;
  Range velocityRange() const;
  Range accelerationRange() const;

  /// True only if position, velocity and acceleration keep the limits over the whole segment; false
  /// says that the exact ranges have to be looked at. Many times cheaper than those.
  bool surelyWithin(const JointLimits& limits) const;

  /// False where the arithmetic overflowed (positions or rates of change beyond any machine).
  bool isFinite() const;

 private:
  SplineSegment(const Polynomial& position, double duration_s);
  Range range(const Polynomial& polynomial, double scale) const;
  /// How much of the segment is over, 0 to 1.
  double share(double t_s) const { return std::clamp(t_s / duration_s_, 0.0, 1.0); }

  Polynomial position_, velocity_, acceleration_;  // over t / duration, and derivatives thereby
  double duration_s_;
};

}  // namespace cia402::motion
