// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "bus/axis_unit.h"
#include "config/robot.h"
#include "motion/joint.h"

namespace cia402::bus {

class CoupledAxes;

/// A joint: what people name, command and see. One axis turns it, or several do together (a
/// coupling); nothing that speaks of joints (trajectories, joint states) asks which.
class Joint {
 public:
  virtual ~Joint() = default;
  Joint(const Joint&) = delete;
  Joint& operator=(const Joint&) = delete;

  /// Its axis has got other limits.
  virtual void adoptLimits() = 0;

  const std::string& name() const { return description_.name; }
  /// For messages: "shoulder", "shoulder (axis m3)", or "pitch (axes m5, m6)".
  const std::string& who() const { return who_; }
  /// Its name, unit and limits.
  const motion::Joint& description() const { return description_; }
  /// With which it is brought to rest, rad/s^2 or m/s^2.
  double stopDeceleration() const { return stop_deceleration_; }
  /// The coupling that it is of: its joints follow trajectories together. nullptr: of none
  virtual const CoupledAxes* coupling() const { return nullptr; }

  /// Writes all of its state there.
  virtual void show(JointState& state) const = 0;
  /// Its position is known.
  virtual bool known() const = 0;
  // Of one that is not known: what is heard of the others of its axes.
  virtual bool partIsLed() const { return false; }  ///< by set-points that are not at rest
  virtual bool partMoves() const { return false; }  ///< as it tells itself
  virtual double position() const = 0;
  virtual Time stamp() const = 0;
  /// What one unit of the drive's position is, rad or m.
  virtual double resolution() const = 0;
  /// Takes set-points: enabled, and no procedure runs.
  virtual bool ready() const = 0;
  /// What was sent last, and how it moves.
  virtual const drive::SetPoint& sent() const = 0;
  /// Still takes set-points, and nothing has ended its motion since sent() had so many breaks().
  virtual bool goesOn(std::uint32_t breaks) const = 0;
  /// stop() was called, and its drive goes to a goal still, or may.
  virtual bool endsGoal() const { return false; }
  /// What was sent last is being handed over to a drive, which moves by it from then on.
  virtual bool handsOver() const = 0;
  /// Cycles were missed before this one.
  virtual bool late() const = 0;

  /// Why it cannot follow trajectories of that group now, in words; empty if it can.
  virtual std::string refusal(const std::string& group) const = 0;
  /// Another group than that one gives its set-points.
  bool followsAnother(const std::string& group) const {
    return leader() != nullptr && *leader() != group;
  }
  /// Something else than that group moves it, or may.
  bool occupied(const std::string& group) const {
    return procedure() != nullptr || followsAnother(group);
  }
  /// What that is, in words, and how to stop it: "home runs, which halt stops". @pre occupied()
  std::string occupation() const;
  /// The procedure that was called to stop it, last of all and since it was ready; none: nothing of
  /// that kind, or it is in fault, which weighs more.
  virtual drive::ProcedureKind stoppedBy() const = 0;
  /// Such a one has not ended.
  bool beingStopped() const { return procedure() != nullptr && drive::stops(procedure()->kind); }
  /// Why it does not do what it is told any more, in words. @param told_before noticeCount() then
  virtual std::string trouble(std::uint32_t told_before) const = 0;
  virtual std::uint32_t noticeCount() const = 0;

  /// Its set-point of this cycle, rad or m. @return false: it is refused, and nothing changes
  [[nodiscard]] virtual bool give(double position) = 0;
  /// See drive::Axis.
  virtual std::string commandRefusal(double value) const = 0;
  virtual Result<void> command(double value, Time at) = 0;
  /// What its set-points are in the mode that it is in; nullptr: that is unknown.
  virtual const drive::ModeSpec* mode() const = 0;
  /// Older than that a command is not followed any more.
  virtual Duration commandTimeout() const = 0;
  /// Brings it to rest. @param over not harder than that takes; zero: as hard as it may be
  virtual void stop(Duration over) = 0;
  void stop() { stop(Duration::zero()); }
  /// A group gives its set-points from now on; nullptr: none any more.
  virtual void follow(const std::string* group) = 0;

 protected:
  /// The procedure that runs on it; nullptr: none.
  virtual const drive::ProcedureStatus* procedure() const = 0;
  /// The group that gives its set-points; nullptr: none.
  virtual const std::string* leader() const = 0;
  Joint(motion::Joint description, std::string who, double stop_deceleration)
      : description_(std::move(description)),
        who_(std::move(who)),
        stop_deceleration_(stop_deceleration) {}
  void limitTo(const motion::Joint& description, double stop_deceleration) {
    description_ = description;
    stop_deceleration_ = stop_deceleration;
  }

 private:
  motion::Joint description_;
  std::string who_;
  double stop_deceleration_;
};

/// In fault, or on its way there.
bool inFault(const drive::Axis& axis);
/// See Joint::stoppedBy().
drive::ProcedureKind stopCalledOn(const drive::Axis& axis);
/// The procedure that runs on an axis; nullptr: none.
const drive::ProcedureStatus* runningOn(const drive::Axis& axis);
/// Why an axis cannot follow trajectories, whatever group asks; empty if it can.
std::string trajectoryRefusal(const drive::Axis& axis);

/// The joints of a bus, in the order of NetworkSnapshot::joints (config::RobotConfig::joints()),
/// and the couplings that move some of them.
class Joints {
 public:
  /// @param units must outlive it, where they are
  Joints(const config::RobotConfig& robot, std::vector<AxisUnit>& units);
  ~Joints();
  Joints(const Joints&) = delete;
  Joints& operator=(const Joints&) = delete;

  const std::vector<std::unique_ptr<Joint>>& all() const { return joints_; }
  /// @return nullptr: there is none of that name
  Joint* find(const std::string& name);
  const std::vector<std::unique_ptr<CoupledAxes>>& couplings() const { return couplings_; }

 private:
  std::vector<std::unique_ptr<CoupledAxes>> couplings_;
  std::vector<std::unique_ptr<Joint>> joints_;
};

}  // namespace cia402::bus
