// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "motion/joint.h"

namespace cia402::motion {

/// A stretch of a path whose jerk is constant.
struct JerkPiece {
  double time;  ///< s, >= 0
  double jerk;  ///< rad/s³ or m/s³
};

/// The quickest way to rest from a velocity and an acceleration: towards the acceleration that
/// brakes, at that, and back to none.
/// @param acceleration largest magnitude, infinity: any; `from` may be beyond it. @param jerk > 0
std::array<JerkPiece, 3> brakingPieces(const MotionState& from, double acceleration, double jerk);

/// Leads one joint along a path whose position, velocity, acceleration and jerk keep to limits, a
/// step at a time, towards places and velocities that change as they like. What it keeps to is
/// meant of the path in time, so of differences of successive steps as well where these are equally
/// long. From each state the joint can come to rest within all limits, unless it was not so when
/// reset() was called; then it brakes. Nothing allocates.
class JerkLimiter {
 public:
  /// @param limits with a jerk; valid
  explicit JerkLimiter(const JointLimits& limits);

  /// Starts from there, with its acceleration.
  void reset(const MotionState& from) { state_ = from; }
  const MotionState& state() const { return state_; }
  /// Where brake() brings it to rest.
  double restsAt() const;

  /// Goes on for `dt` s, so as to come to rest relative to something that is at `position` then and
  /// moves with `velocity`. @return nothing but that was minded: the joint follows it
  bool approach(double position, double velocity, double dt);
  /// Goes on for `dt` s towards a velocity. What it knows of the position was told by reset().
  /// @param reaction_s how long the joint carries on before it follows
  void turn(double velocity, double dt, double reaction_s);
  /// Goes on for `dt` s on the quickest way to rest.
  void brake(double dt);

 private:
  /// How far a joint that moves with `velocity` >= 0 may be ahead of where it was told to be, as
  /// its feedback and its reaction together are late by `reaction_s`: it was faster by its
  /// acceleration before, and by what its jerk may have made of that.
  double unseen(double velocity, double reaction_s) const;
  /// Whether a jerk carries the joint beyond a limit, to the one side or the other, now or on the
  /// way to rest after `dt` s of it.
  bool tooHigh(double jerk, double dt, double reaction_s) const;
  bool tooLow(double jerk, double dt, double reaction_s) const;
  /// Goes on with the jerk that `error`, which rises with it, makes nothing of, as far as the
  /// limits permit. @return they permit it
  template <typename Error>
  bool goOn(const Error& error, double dt, double reaction_s);

  double lower_, upper_, velocity_, acceleration_, jerk_;  // infinite where there is none
  MotionState state_;
};

}  // namespace cia402::motion
