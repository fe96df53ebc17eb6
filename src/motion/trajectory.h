// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cia402_driver/common/time.h"
#include "cia402_driver/motion/trajectory_error.h"
#include "cia402_driver/motion/trajectory_point.h"
#include "motion/joint.h"
#include "motion/spline.h"
#include "motion/time_law.h"
#include "motion/trajectory_rules.h"

namespace cia402::motion {

class TrajectoryPlan;
class TrajectoryResult;

/// When and how a trajectory begins.
struct TrajectoryStart {
  Time now{};
  /// What time_from_start counts from; absent: now. (A zero stamp in the ROS message means absent.)
  std::optional<Time> start_time;
  /// Shift all positions of each continuous joint by whole turns, so that the first point that is
  /// still ahead lies at most half a turn from the present position; where it is half a turn either
  /// way (within 1e-9 rad), in the direction in which it was given.
  bool shortest_way = false;

  /// When the new trajectory takes over: the later of start time and now. The states given to
  /// Trajectory::create are those commanded at this time.
  Time begin() const { return std::max(now, start_time.value_or(now)); }
};

/// A checked trajectory of several joints: what ros_controllers' joint_trajectory_controller makes
/// of the same message. The joints leave from the present commanded state, so that a new trajectory
/// pre-empts another smoothly, and follow one spline segment from point to point: quintic where
/// both ends have accelerations, cubic where both have velocities, else linear. The present state
/// has both. A joint with a limit of acceleration goes through points without velocities by cubics
/// that swing nowhere beyond them.
///
/// create() allocates, sampling does not.
class Trajectory {
 public:
  /// Checks everything before anything moves. `joints` and `commanded` have one entry a joint.
  ///
  /// Points at or before begin() are dropped, also such as lie before the start (time_from_start
  /// below 0). Refused with a sentence that names joint, point (the
  /// first is 0), value and limit are:
  /// - INVALID_JOINTS: no joints, or not one commanded state a joint;
  /// - INVALID_GOAL: sizes that differ from the number of joints, values that are not finite, times
  ///   that do not rise; no point that is still ahead; a last point with a velocity above
  ///   kRestVelocity (the joint would have to stop there at once) where `rules` have it end at
  ///   rest;
  /// - INVALID_GOAL: position, velocity or acceleration beyond the joint's limits anywhere on the
  ///   way still ahead, not only at the points, by more than 1e-6 of the limit (for positions: of
  ///   the range). A joint that is outside its position limits already may move back, not further.
  ///   Jerk is not checked: between cubic segments it has no bound.
  /// Where `rules` are not strict velocities and accelerations beyond the limits are slowed down
  /// instead, if the points themselves ask for none that are, see TrajectoryRules.
  /// No points at all are a valid trajectory that asks for a stop: the caller brings the joints
  /// to rest. Sampling holds the commanded positions.
  static TrajectoryResult create(const std::vector<Joint>& joints,
                                 const std::vector<MotionState>& commanded,
                                 const std::vector<TrajectoryPoint>& points,
                                 const TrajectoryStart& start, const TrajectoryRules& rules = {});

  /// A last velocity up to this counts as rest, in rad/s or m/s.
  static constexpr double kRestVelocity = 1e-3;

  /// Writes the states of the joints at `time`, as many as `states` has room for; never resizes
  /// it. Before startTime() (the caller still plays the previous trajectory) the positions it
  /// begins from, at rest; from endTime() on the last positions, at rest.
  void sample(Time time, std::vector<MotionState>& states) const;
  /// The same for one joint, as numbered in `joints` of create().
  MotionState sample(std::size_t joint, Time time) const;
  /// The positions of that alone, many times cheaper: what a cycle needs.
  void samplePositions(Time time, std::vector<double>& positions) const;

  /// So many of the first points had passed before it began.
  std::size_t droppedPoints() const { return dropped_points_; }
  bool finished(Time time) const { return time >= endTime(); }
  Time startTime() const { return begin_; }
  Time endTime() const { return end_; }
  /// How much later than asked it ends, s; below 0 where a stream's point is reached sooner.
  double delay() const { return delay_s_; }
  /// What would have been beyond a limit had it not been slowed down, in words; empty: nothing.
  const std::string& excess() const { return excess_; }
  /// It is brought to rest behind its last point.
  bool endsInMotion() const { return ends_in_motion_; }
  /// Where the joints come to rest, one entry a joint, whole turns of shortest_way included.
  const std::vector<double>& goal() const { return goal_; }

 private:
  Trajectory() = default;
  /// How long the ways to the points after begin_ take; `base` is where their times count from.
  std::optional<TrajectoryError> takePointsAhead(const std::vector<TrajectoryPoint>& points,
                                                 Time base, std::vector<double>& durations_s);
  void take(const TrajectoryPlan& plan);
  /// A place on the path: the segment, and how far in it.
  struct PathPlace {
    std::size_t segment;
    double since_s;
  };
  PathPlace placeAt(double along_s) const;
  MotionState rest(std::size_t joint, Time time) const;

  std::size_t joint_count_ = 0;
  std::size_t dropped_points_ = 0;  ///< of the first: they had passed before it began
  Time begin_{}, end_{};
  std::vector<double> ends_s_;           // one a segment, along the path
  std::vector<SplineSegment> segments_;  // joint_count_ of them a segment
  TimeLaw law_;
  double delay_s_ = 0.0;
  std::string excess_;
  bool ends_in_motion_ = false;
  std::vector<double> origin_, goal_;
};

/// A trajectory, or why it was refused.
class [[nodiscard]] TrajectoryResult {
 public:
  TrajectoryResult(Trajectory value) : state_(std::move(value)) {}       // NOLINT: implicit
  TrajectoryResult(TrajectoryError error) : state_(std::move(error)) {}  // NOLINT: implicit

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  /// @throws std::bad_variant_access if this holds an error.
  const Trajectory& value() const& { return std::get<0>(state_); }
  Trajectory&& value() && { return std::get<0>(std::move(state_)); }
  const Trajectory& operator*() const& { return value(); }
  const Trajectory* operator->() const { return &value(); }

  /// @throws std::bad_variant_access if this holds a trajectory.
  const TrajectoryError& error() const { return std::get<1>(state_); }

 private:
  std::variant<Trajectory, TrajectoryError> state_;
};

/// A joint that a message names.
struct JointPlace {
  std::size_t joint;  ///< of the group
  std::size_t place;  ///< in the message
};

/// Where the joints of a group are in the message's `names`, in the group's order. Every joint must
/// be named exactly once and no other; the error (code INVALID_JOINTS) lists all that are unknown,
/// missing or named twice. @param partial joints may be missing, but not all
Result<std::vector<JointPlace>> matchJoints(const std::vector<Joint>& joints,
                                            const std::vector<std::string>& names,
                                            bool partial = false);

}  // namespace cia402::motion
