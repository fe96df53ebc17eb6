// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "cia402_driver/common/result.h"
#include "cia402_driver/drive/axis.h"
#include "cia402_driver/motion/setpoint_limiter.h"
#include "cia402_driver/motion/stop_ramp.h"

namespace cia402::bus {

/// The joint of an axis with its limits, as the motion module sees it.
motion::Joint jointOf(const drive::AxisConfig& config);

/// Deceleration with which an axis is stopped by set-points: its acceleration limit, or 5 rad/s²
/// (0.5 m/s²) where none is configured.
double stopDeceleration(const drive::AxisConfig& config);
/// How the set-points of an axis are brought to rest: with stopDeceleration(), within its limits.
motion::StopLimits stopLimits(const drive::AxisConfig& config);

/// Makes the set-points of one axis from streamed commands (`~<axis>/command`): limits position,
/// velocity and acceleration, and stops the axis when a stream of velocities or efforts dries up.
/// Idle while a trajectory group moves the axis.
class AxisMotion {
 public:
  /// @param cycle the period of step().
  AxisMotion(const drive::AxisConfig& config, Duration cycle);

  /// A set-point of the active mode (rad or m, per s, N m or N). Refused with a sentence if the
  /// axis is not ready for motion, a group moves it, or the value is not finite.
  Result<void> command(const drive::Axis& axis, double value, Time now);
  /// Gives the axis its set-point of this cycle.
  void step(drive::Axis& axis, Time now);

  /// A trajectory group takes the axis over (`name`), or gives it back (nullptr); the name must
  /// outlive the taking. Commands are forgotten.
  void setOwner(const std::string* name) { owner_ = name; }
  const std::string* owner() const { return owner_; }
  /// Forgets the command and ramps a moving axis down to rest. An axis whose drive plans the motion
  /// is left to it.
  void stop(const drive::Axis& axis, Time now);
  /// Are the set-points of this cycle at rest?
  bool atRest() const { return at_rest_; }

 private:
  void enter(const drive::Axis& axis, Time now);
  void rest(const drive::Axis& axis, Time now);
  void forgetLateCycles(const drive::Axis& axis, Time now);
  void stepPosition(drive::Axis& axis, Time now);
  void stepVelocity(drive::Axis& axis, Time now);
  void stepTorque(drive::Axis& axis, Time now);
  bool entered(const drive::Axis& axis) const;
  /// The axis refused a velocity or an effort: it must not go on with the one before.
  void zero(drive::Axis& axis, Time now);

  motion::PositionLimiter position_;
  motion::VelocityLimiter velocity_;
  Duration cycle_, timeout_;
  std::optional<double> effort_limit_;
  const std::string* owner_ = nullptr;
  const drive::ModeSpec* mode_ = nullptr;  // for which the limiters were reset
  std::uint32_t zero_changes_ = 0;         // of the axis, then
  std::optional<double> command_;
  std::optional<motion::StopRamp> ramp_;  // of a stopped position stream
  Time commanded_{}, stepped_{};
  bool at_rest_ = true;
};

}  // namespace cia402::bus
