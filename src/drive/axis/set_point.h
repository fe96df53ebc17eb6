// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "cia402_driver/common/time.h"
#include "drive/profile/profile.h"
#include "motion/joint.h"
#include "motion/stop_ramp.h"

namespace cia402::drive {

/// What a set-point is and what the drive makes of it.
enum class SetPointKind : std::uint8_t {
  none,      ///< the mode takes no set-points (homing)
  stream,    ///< positions, a new one each cycle; the drive stands at the last one
  goal,      ///< a position that the drive goes to by itself
  velocity,  ///< the drive turns on with the last one
  torque,    ///< the drive pushes on with the last one
};

/// The one owner of an axis' set-point: knows what was sent last, how fast that moves, and stops
/// it.
///
/// A set-point is a lease of one cycle. Who moves an axis gives one in every cycle; what moves and
/// is not renewed is brought to rest. Everything advances by one period a cycle, however late the
/// cycle is: what a late cycle missed is never made good. Every stop starts from what was sent
/// last, whoever asks for it and however often. Joint units; nothing allocates.
class SetPoint {
 public:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  /// @param limits of position, which a stop does not go beyond, and of velocity, which a stream
  /// never exceeds. @param deceleration > 0, rad/s^2 or m/s^2, with which everything is brought to
  /// rest
  SetPoint(const motion::JointLimits& limits, double deceleration, Duration cycle);

  /// Keeps to these from now on; they may have changed. @pre it is at rest
  void adopt(const motion::JointLimits& limits, double deceleration);
  /// Begins anew, at rest: at the position `value`, or with no velocity or torque.
  void rest(SetPointKind kind, double value);
  /// Takes over a motor that turns: begins at its velocity, per s, and ramps that to rest.
  void arrest(double velocity);
  /// The set-point of this cycle; in a stream it is approached no faster than the velocity limit.
  /// Ends a stop. @pre value is finite
  void give(double value) {
    given_ = value;
    has_given_ = true;
  }
  /// Brings to rest: a stream or a velocity by a ramp, a torque at once; a goal is left to the
  /// drive. @param over of a stream: the ramp is not harder than it takes to come to rest in that
  /// time, or in front of a limit of position; zero: as hard as it may be, also one that goes on
  /// more gently. Else nothing changes while stopping, or at rest.
  void stop(Duration over = Duration::zero());
  /// At least one cycle was missed: who follows a stream of positions has come to rest meanwhile.
  void interrupt();
  /// A stream that the axis has run ahead of: goes on from where that is, rad or m, and ramps its
  /// velocity, per s, to rest.
  void overtake(double position, double velocity);
  /// Grows with each interrupt() of a moving stream.
  std::uint32_t interruptions() const { return interruptions_; }
  /// Positions have got another zero. @param by what is added to all of them
  void shift(double by);

  /// Makes the set-point of this cycle. @return true if it differs from the last one
  bool advance(Time now);

  SetPointKind kind() const { return kind_; }
  /// What was sent last: rad or m, per s, N m or N; NaN where nothing was.
  double value() const { return value_; }
  /// Position: how fast it moves. Velocity: the value.
  double velocity() const { return kind_ == SetPointKind::velocity ? value_ : velocity_; }
  bool stopping() const { return stopping_; }
  /// A set-point was given for the last cycle.
  bool leased() const { return leased_; }
  /// Nothing that was sent moves the axis; a goal counts as rest, see movedAt().
  bool atRest() const;
  /// Position and velocity `ahead` of now if nothing is given any more.
  struct Motion {
    double position, velocity;
  };
  Motion expected(Duration ahead) const;
  /// The goals since the axis came to one of them at rest, and where it was then: the drive may
  /// take them one by one, and goes to any of them. rad or m
  struct Goals {
    double lowest = kNone, highest = kNone;
  };
  const Goals& goals() const { return goals_; }
  /// It has come to the last one.
  void forgetGoals() { goals_ = {value_, value_}; }
  /// When the last set-point left that moved the axis, or could have.
  Time movedAt() const { return moved_at_; }
  /// Grows with all that ends a motion, other than who gives its set-points: a stop, another zero,
  /// a new beginning.
  std::uint32_t breaks() const { return breaks_; }
  /// What was commanded cannot be reached: whoever gave it gives it no more.
  void giveUp() { ++given_up_; }
  /// How often that was so.
  std::uint32_t givenUp() const { return given_up_; }

 private:
  void beginStop(Duration over = Duration::zero());
  double gentlest(Duration over) const;
  void beginRamp(motion::StopRamp& ramp, double deceleration) const;
  void advanceStop();
  void follow();
  double withinLimits(double position) const;

  motion::JointLimits limits_;
  double deceleration_ = 0.0;
  double cycle_s_, furthest_ = 0.0;  ///< step of a stream
  Duration cycle_;
  SetPointKind kind_ = SetPointKind::none;
  double value_ = kNone, velocity_ = 0.0;
  double given_ = kNone;
  bool has_given_ = false, stopping_ = false, leased_ = false;
  Goals goals_;
  motion::StopRamp ramp_;
  Time moved_at_ = Time::min();
  std::uint32_t breaks_ = 0, interruptions_ = 0, given_up_ = 0;
};

}  // namespace cia402::drive
