// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bus/axis_unit.h"
#include "config/robot.h"
#include "motion/joint.h"

namespace cia402::bus {

/// A joint: what people name, command and see. An axis turns it; nothing that speaks of joints
/// (trajectories, joint states, the order of homing) asks which.
class Joint {
 public:
  /// @param unit the axis that turns it, one for one; must outlive it.
  explicit Joint(AxisUnit& unit);

  /// Its axis has got other limits.
  void adoptLimits();

  const std::string& name() const { return description_.name; }
  /// For messages: "shoulder", or "shoulder (axis m3)".
  const std::string& who() const { return who_; }
  /// Its name, unit and limits.
  const motion::Joint& description() const { return description_; }
  /// With which it is brought to rest, rad/s^2 or m/s^2.
  double stopDeceleration() const { return stop_deceleration_; }

  JointState state() const;
  /// Joints of a lower order home first.
  int homingOrder() const;
  double position() const { return axis().state().position; }
  Time stamp() const { return axis().state().stamp; }
  /// What one unit of the drive's position is, rad or m.
  double resolution() const { return axis().positionResolution(); }
  /// Takes set-points: enabled, and no procedure runs.
  bool ready() const { return axis().state().ready_for_motion; }
  /// What was sent last, and how it moves.
  const drive::SetPoint& sent() const { return axis().setPoint(); }
  /// Cycles were missed before this one.
  bool late() const { return axis().late(); }

  /// Why it cannot follow trajectories of that group now, in words; empty if it can.
  std::string refusal(const std::string& group) const;
  /// Another group than that one gives its set-points.
  bool followsAnother(const std::string& group) const {
    return axis().leader() != nullptr && *axis().leader() != group;
  }
  /// Why it does not do what it is told any more, in words. @param told_before noticeCount() then
  std::string trouble(std::uint32_t told_before) const;
  std::uint32_t noticeCount() const { return axis().noticeCount(); }

  /// Its set-point of this cycle, rad or m. @return false: it is refused, and nothing changes
  [[nodiscard]] bool give(double position) { return unit_->axis.setTarget(position); }
  /// See drive::Axis.
  std::string commandRefusal(double value) const { return axis().commandRefusal(value); }
  Result<void> command(double value, Time at) { return unit_->axis.command(value, at); }
  /// What its set-points are in the mode that it is in; nullptr: that is unknown
  const drive::ModeSpec* mode() const { return axis().state().mode; }
  /// Older than that a command is not followed any more.
  Duration commandTimeout() const { return axis().config().command_timeout; }
  /// Brings it to rest. @param over not harder than that takes; zero: as hard as it may be
  void stop(Duration over = Duration::zero()) { unit_->axis.stopSetPoint(over); }
  /// A group gives its set-points from now on; nullptr: none any more.
  void follow(const std::string* group) { unit_->axis.follow(group); }

 private:
  const drive::Axis& axis() const { return unit_->axis; }

  AxisUnit* unit_;
  motion::Joint description_;
  std::string who_;
  double stop_deceleration_;
};

/// Those of a robot, in the order of NetworkSnapshot::joints.
std::vector<motion::Joint> jointsOf(const config::RobotConfig& robot);

/// The joints of a bus, in the order of the configuration, and which axis turns which: each one,
/// so far.
class Joints {
 public:
  explicit Joints(std::vector<AxisUnit>& units);  ///< @param units must outlive it, where they are
  Joints(const Joints&) = delete;
  Joints& operator=(const Joints&) = delete;

  std::vector<Joint>& all() { return joints_; }
  const std::vector<Joint>& all() const { return joints_; }
  /// @return nullptr: there is none of that name
  Joint* find(const std::string& name);
  /// That which an axis turns. @param axis index in the configuration
  const Joint& ofAxis(std::size_t axis) const { return joints_[axis]; }

 private:
  std::vector<Joint> joints_;
};

}  // namespace cia402::bus
