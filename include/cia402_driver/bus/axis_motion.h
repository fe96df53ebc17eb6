// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "cia402_driver/common/result.h"
#include "cia402_driver/drive/axis.h"
#include "cia402_driver/motion/setpoint_limiter.h"

namespace cia402::bus {

/// The joint of an axis with its limits, as the motion module sees it.
motion::Joint jointOf(const drive::AxisConfig& config);

/// Makes the set-points of one axis from streamed commands (`~<axis>/command`): limits position,
/// velocity and acceleration. When a stream of velocities dries up it is ramped down, one of
/// efforts is given up, so that the axis brakes or coasts as configured. Goes on from what the axis
/// sent last, by one period a cycle. Idle while a trajectory group moves the axis.
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
  /// Forgets the command and brings a moving axis to rest. An axis whose drive plans the motion is
  /// left to it.
  void stop(drive::Axis& axis);
  /// Are the set-points of this cycle at rest?
  bool atRest() const { return at_rest_; }
  /// The last velocity or effort that was commanded, unless it was zero, was given up for want of a
  /// newer one (AxisConfig::command_timeout). Until the next command, or the mode is left.
  bool driedUp() const { return dried_up_; }

 private:
  void enter(const drive::Axis& axis);
  /// The limiters go on from what the axis sent last. @param at when that was, in clock_
  void resume(const drive::Axis& axis, Time at);
  void stepPosition(drive::Axis& axis);
  void stepVelocity(drive::Axis& axis, Time now);
  void stepTorque(drive::Axis& axis, Time now);
  bool entered(const drive::Axis& axis) const;

  motion::PositionLimiter position_;
  motion::VelocityLimiter velocity_;
  Duration cycle_, timeout_;
  std::optional<double> effort_limit_;
  const std::string* owner_ = nullptr;
  const drive::ModeSpec* mode_ = nullptr;  // for which the limiters were reset
  std::uint32_t zero_changes_ = 0;         // of the axis, then
  std::uint32_t breaks_ = 0, interruptions_ = 0, given_up_ = 0;  // of its set-point, as last seen
  std::optional<double> command_;
  Time clock_{};      // one period a cycle, however late it is
  Time commanded_{};  // in the time of the bus
  bool at_rest_ = true;
  bool dried_up_ = false;
};

}  // namespace cia402::bus
