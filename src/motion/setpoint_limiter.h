// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "cia402_driver/common/result.h"
#include "cia402_driver/common/time.h"
#include "motion/jerk_limiter.h"
#include "motion/joint.h"

namespace cia402::motion {

/// What both kinds of limiter of one joint's streamed set-points share: the command and the
/// permissible next velocity. They keep the limits of position, velocity, acceleration and, where
/// there is one, jerk; a command counts until the next one.
///
/// Velocity and acceleration are meant as differences of successive outputs over the time between
/// the steps, so that what the drive is given keeps the limits exactly, whatever the jitter of the
/// cycle; with a limit of jerk they are meant as JerkLimiter has them. The joint can always be
/// stopped before a position limit with the acceleration limit, unless it was not so when reset()
/// was called; then it brakes with the acceleration limit. From outside the position limits it can
/// only move back, as far as it is told. No function allocates but command() when it refuses.
class SetpointLimiter {
 protected:
  /// @param joint its limits are valid: finite, those of magnitude above 0, lower below upper
  explicit SetpointLimiter(Joint joint) : joint_(std::move(joint)) {}
  ~SetpointLimiter() = default;

  /// Keeps to these from now on. @pre they are valid; reset() follows
  void limitTo(const JointLimits& limits) { joint_.limits = limits; }
  void resetTo(const MotionState& state, Time now);
  Result<void> take(double command, const char* power);
  /// The velocity nearest to `desired` from which the joint can stop `margin` before the limits of
  /// position, as it carries on for `delay_s` before it brakes; and within that of velocity.
  double stoppable(double desired, double position, double delay_s, double margin) const;
  /// The velocity nearest to `desired` that all limits permit at `position` for a step of `dt` s.
  /// `reaction_s` is how long the joint carries on before it follows.
  double permitted(double desired, double position, double dt, double reaction_s) const;
  /// The next velocity on the way to rest.
  double slower(double dt) const;

  Joint joint_;
  MotionState output_;  ///< what the last step() gave
  std::optional<double> command_;
  Time stepped_{};
  std::optional<JerkLimiter> smooth_;  ///< where there is a limit of jerk
};

/// Follows streamed positions. A stream that keeps the limits and gives a position each cycle comes
/// out unchanged; anything else (steps, slower or irregular streams) is approached as fast as the
/// limits permit, each position as one to stop at without overshoot. With a limit of jerk a stream
/// that keeps it is followed as closely as its acceleration can be had with that, a³/(3 j²) behind
/// while it accelerates. A stream that was followed and
/// ends at speed is brought to rest ahead of its last position; nothing turns back to that.
class PositionLimiter : public SetpointLimiter {
 public:
  explicit PositionLimiter(Joint joint) : SetpointLimiter(std::move(joint)) {}
  using SetpointLimiter::limitTo;

  /// Starts from the present commanded state, without a command. A velocity that is not finite
  /// counts as 0. @pre the position is finite; where it is not, no output is.
  void reset(const MotionState& commanded, Time now);
  /// A new set-point, in rad or m. Beyond the position limits it counts as the limit. Refused, and
  /// the previous one kept, if it is not finite.
  Result<void> command(double position);
  /// The state to command now, to be called once a cycle with rising times.
  MotionState step(Time now);
  /// Where the joint goes: the last command, or where it came to rest after a stream that ended at
  /// speed; nothing before the first command.
  const std::optional<double>& goal() const { return command_; }

 private:
  double approach(double dt) const;
  /// How fast the commands move, by the last two.
  double streamVelocity(double dt) const;
  void stepSmoothly(double dt);
  /// With a limit of jerk: what it can be told to go to, if not within its limits.
  double outermost() const;

  std::optional<double> previous_command_;  // the cycle before: its command, or where it held
  bool fresh_ = false;
  bool met_ = false;  // the last step came out at the command
};

/// Follows streamed velocities.
class VelocityLimiter : public SetpointLimiter {
 public:
  /// `reaction`: how long the drive carries on with the previous velocity after step(), e.g. two
  /// cycles; the braking distance before a position limit is longer by as much.
  explicit VelocityLimiter(Joint joint, Duration reaction = {})
      : SetpointLimiter(std::move(joint)), reaction_s_(toSeconds(reaction)) {}
  using SetpointLimiter::limitTo;

  /// Starts from the present commanded state, without a command.
  void reset(const MotionState& commanded, Time now);
  /// A new set-point, in rad/s or m/s; refused as by PositionLimiter.
  Result<void> command(double velocity);
  /// The state to command now; its position is `position`, the measured one. NaN: unknown; a joint
  /// with position limits is then stopped.
  MotionState step(Time now, double position);

 private:
  double reaction_s_;
};

}  // namespace cia402::motion
