// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/axis_unit.h"
#include "bus/event.h"
#include "bus/gantry_watch.h"
#include "bus/joint.h"
#include "config/robot.h"
#include "motion/coupling.h"
#include "motion/setpoint_limiter.h"

namespace cia402::bus {

/// Axes that move joints together: joint space = matrix * axis space.
///
/// Set-points of the joints are owned here, so that limits and stops are those of the joints; the
/// axes get what the matrix makes of them, all of them in the same cycle. Where one axis ends its
/// set-points by itself (a fault, a halt), the others are brought to rest with it. The sides of a
/// gantry are stopped together whatever they do.
class CoupledAxes {
 public:
  /// @param config valid, @param units those of config.axes, in that order; must outlive this
  CoupledAxes(const config::CouplingConfig& config, std::vector<AxisUnit*> units, Duration cycle);

  /// Its joints; this must outlive them.
  std::vector<std::unique_ptr<Joint>> makeJoints();
  const config::CouplingConfig& config() const { return config_; }
  /// What is done to one axis is done to all: the sides of a gantry.
  bool asOne() const { return watch_.has_value(); }
  /// Why no set-point is taken for one of its axes alone, in words.
  std::string streamRefusal(const drive::AxisConfig& axis) const;

  // Of a cycle:
  /// New feedback has come, and nothing has given set-points yet.
  void update(Time now, EventSink& events);
  /// The joints have their set-points: gives the axes theirs.
  void move(Time now);

  // Of one joint, its index in config().joints:
  void show(std::size_t joint, JointState& state) const;
  double positionOf(std::size_t joint) const { return config_.matrix->toJoint(joint, positions_); }
  Time stampOf(std::size_t joint) const;
  double resolutionOf(std::size_t joint) const;
  const drive::SetPoint& sentOf(std::size_t joint) const { return sent_[joint]; }
  [[nodiscard]] bool give(std::size_t joint, double position);
  void stop(std::size_t joint, Duration over) { sent_[joint].stop(over); }
  // Of all:
  bool ready() const;
  bool axesRest() const;  ///< nothing that was sent to them moves them
  bool axesMove() const;  ///< one that is heard does
  bool handOver() const;  ///< one does, see drive::Axis::handsOver()
  bool late() const;
  std::string refusal(const std::string& group) const;
  drive::ProcedureKind stoppedBy() const;
  std::string trouble() const;
  std::uint32_t noticeCount() const;
  void follow(const std::string* group);
  const std::string* leader() const;
  /// That runs on one of them; nullptr: none.
  const drive::ProcedureStatus* procedure() const;

 private:
  bool takesPositions() const;
  bool broken() const;
  void stopBoth(const std::string& why, Time now, EventSink& events);
  void begin();
  void breakOff();
  void rebase();
  double square(bool leased);
  double withinAxis(std::size_t axis, double value) const;

  config::CouplingConfig config_;
  std::vector<AxisUnit*> units_;
  std::string who_;
  std::optional<GantryWatch> watch_;
  Eigen::VectorXd positions_, velocities_, efforts_;  ///< measured, of the axes
  Eigen::VectorXd wanted_, targets_;                  ///< set-points of the joints, and the axes
  std::vector<drive::SetPoint> sent_;                 ///< of the joints
  std::vector<std::uint32_t> breaks_, notices_;       ///< of the axes, as their set-points began
  std::string stopped_;                               ///< why both sides were stopped
  bool driving_ = false;                              ///< the axes get set-points each cycle

  // Of a gantry, the set-points' skew that is taken back:
  motion::PositionLimiter squaring_;
  motion::MotionState skew_;
  Time clock_{};
  Duration cycle_;
  bool squares_ = false;
};

}  // namespace cia402::bus
