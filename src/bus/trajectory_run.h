// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bus/joint.h"
#include "bus/motion_clock.h"
#include "bus/trajectory_order.h"
#include "cia402_driver/bus/trajectory_outcome.h"
#include "config/robot.h"
#include "drive/axis/standstill.h"
#include "motion/trajectory.h"

namespace cia402::bus {

/// How much later than asked a trajectory ends, and why, in words.
std::string slowedText(const motion::Trajectory& trajectory);

/// One trajectory and those joints of a group that follow it, from when it was accepted until they
/// stand. A later one may take some of them over, or all.
class TrajectoryRun {
 public:
  /// @param joints those of the trajectory, in its order; they are ready. Must outlive the run.
  /// @param trajectory absent: it only waits until they stand, whatever brings them to rest
  TrajectoryRun(const config::GroupConfig& group, TrajectoryOrder order,
                const std::vector<Joint*>& joints, std::optional<motion::Trajectory> trajectory);

  std::uint64_t id() const { return order_.id; }
  bool waiting() const { return is(Phase::waiting); }
  bool following() const { return is(Phase::following); }
  bool stopping() const { return is(Phase::stopping); }
  /// All its joints were taken over, or all that were well, or end() was called.
  bool ended() const { return members_.empty() || is(Phase::ended); }
  bool hasTrajectory() const { return trajectory_.has_value(); }
  bool has(const Joint& joint) const;
  /// They share a joint.
  bool meets(const TrajectoryRun& other) const;
  /// It has no joints but those.
  bool within(const std::vector<Joint*>& joints) const;

  /// @pre waiting() or following()
  Time startTime() const { return trajectory_->startTime(); }
  /// It leads a joint, or will: it does not stop, and the joint did not fall out.
  bool leads(const Joint& joint) const;
  /// Where it has that joint at `time` of the group's clock, also before it has begun.
  /// @pre leads(joint)
  motion::MotionState state(const Joint& joint, Time time) const;
  /// Where it has a joint at `time` of the group's clock; absent: it does not say, for it has not
  /// begun, it stops, or the joint fell out.
  std::optional<motion::MotionState> planned(const Joint& joint, Time time) const;
  /// How fast the clock's rate may rise for it, 1/s. @pre following()
  double permittedRise(const MotionClock& clock) const;

  /// The group's configuration is another one.
  void adopt();
  /// Its joints follow it from now on.
  void begin(Time now);
  /// Another takes a joint over; who waited for this one is told so.
  void leave(const Joint& joint, const TrajectoryOutcome& replaced);
  /// The same for all joints that the other run has.
  void leave(const TrajectoryRun& other, const TrajectoryOutcome& replaced);
  /// Brings its joints to rest, as hard as they may where `why` has the code of a failure, else
  /// within stop_trajectory_duration. Who waits is told at once where it failed, else when they
  /// stand.
  void stop(const TrajectoryOutcome& why);
  /// While it stops: as hard as its joints may.
  void hasten();
  /// It has no trajectory, and its joints are being stopped.
  void expectRest(const TrajectoryOutcome& outcome) { outcome_ = outcome; }
  /// Ends it without a word to its joints, of which it knows still.
  void end(const TrajectoryOutcome& outcome);

  /// A joint that was not ready for a while, or whose set-points were ended by anything else
  /// (another zero of its positions, a motor that stands), is not where this was planned from.
  void noteDropped();
  /// Why its joints are to stop, with the end `failed`, or `stopped` where a procedure was called
  /// that stops one of them. @param time of the group's clock. @pre following()
  std::optional<TrajectoryOutcome> failure(Time time) const;
  /// The goal was sent already: given once more, the set-points are at rest there. @pre following()
  bool atGoal(Time time) const;
  /// Gives the joints their set-points. @pre following()
  void follow(Time time);
  /// How it ended; absent: the goal is waited for still, or it stops, for a procedure was called
  /// that stopped one of its joints on the way. @pre following(), atGoal()
  std::optional<TrajectoryOutcome> arrival(Time time);
  /// Its joints stand, as was commanded and as their motors are measured, or one that should does
  /// not: what it has come to. @pre stopping()
  std::optional<TrajectoryOutcome> standstill(Time now);

 private:
  enum class Phase : std::uint8_t { waiting, following, stopping, ended };
  struct Member {
    Joint* joint;
    std::size_t place;  ///< in the trajectory
    config::JointTolerance tolerance;
    std::uint32_t breaks, notices, given_up;  ///< of the joint, as it was taken
    bool dropped;                             ///< it fell out of operation under way
    drive::Standstill rest;  ///< of the motor, since the goal was sent or it is stopped
    drive::ProcedureKind stopped_by = drive::ProcedureKind::none;  ///< what it was dropped for
  };

  /// nullptr: it has none such, or that fell out.
  const Member* memberOf(const Joint& joint) const;
  config::JointTolerance toleranceOf(const std::string& joint) const;
  /// s
  double goalTime() const { return order_.tolerances.goal_time.value_or(group_->goal_time); }
  bool is(Phase phase) const { return phase_ == phase && !members_.empty(); }
  std::optional<TrajectoryOutcome> axisFailure() const;
  /// How it ends where a member was dropped because a procedure was called that stops it.
  TrajectoryOutcome calledStop(const Member& member) const;
  std::optional<TrajectoryOutcome> pathFailure(Time time) const;
  bool rests(const Member& member) const;
  /// It is to be stopped, and something else than this group moves it, or may.
  bool occupied(const Member& member) const;
  TrajectoryOutcome notStopped(const Member& member) const;
  TrajectoryOutcome notKnown(const Member& member) const;
  TrajectoryOutcome restlessness(const Member& member) const;
  /// "elbow still moves at 0.3 rad/s".
  std::string stillMoves(const Member& member) const;
  /// "its stopped_velocity_tolerance is 0.01 rad/s; see whether it swings or is pushed".
  std::string restAsked(const Member& member) const;
  TrajectoryOutcome blame(motion::TrajectoryErrorCode code, const Member& member, double off,
                          const std::string& text) const;

  const config::GroupConfig* group_;
  TrajectoryOrder order_;
  std::vector<Member> members_;
  std::optional<motion::Trajectory> trajectory_;
  std::vector<double> positions_;  ///< that were given last, as the trajectory numbers them
  Phase phase_;
  Time began_{};                        ///< in the time of the bus
  const Joint* refused_ = nullptr;      ///< the one that did not take its set-point
  TrajectoryOutcome outcome_;           ///< while it stops
  std::optional<Time> commanded_rest_;  ///< while it stops: all set-points are at rest since then
};

}  // namespace cia402::bus
