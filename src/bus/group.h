// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bus/joint.h"
#include "bus/motion_clock.h"
#include "cia402_driver/bus/trajectory_outcome.h"
#include "config/robot.h"
#include "motion/trajectory.h"

namespace cia402::bus {

/// A set of joints that follow trajectories together. One trajectory at a time; a new one takes
/// over smoothly from where the present one is.
class Group {
 public:
  /// @param joints those of config.joints, in that order; must outlive the group.
  /// @param cycle period of the bus
  Group(config::GroupConfig config, std::vector<Joint*> joints, Duration cycle);

  const config::GroupConfig& config() const { return config_; }

  /// Checks a trajectory and takes it over; without points, stops. Points are in the order of
  /// `names`. On an error nothing changes. @param ended told how it ended, if it is accepted
  TrajectoryOutcome start(const std::vector<std::string>& names,
                          const std::vector<motion::TrajectoryPoint>& points,
                          std::optional<Time> start_time, Time now, TrajectoryEnded ended = {});
  /// Brings all joints to rest and ends the trajectory with `why`.
  void stop(const TrajectoryOutcome& why);
  /// Gives the axes their set-points of this cycle. @return how the trajectory ended, in the cycle
  /// in which it did. Not inlined: it would push apart what each of the more axes does there.
  [[gnu::noinline]] std::optional<TrajectoryOutcome> step(Time now);

  /// A trajectory is being followed, or its beginning or end is awaited.
  bool executing() const { return phase_ == Phase::following || next_.has_value(); }
  /// The joints are being brought to rest.
  bool stopping() const { return phase_ == Phase::stopping; }
  /// Commanded states, one a joint; valid while executing or stopping. Made on demand: allocates.
  std::vector<motion::MotionState> commanded() const;

 private:
  enum class Phase { idle, following, stopping };

  std::string refusal() const;
  /// Where the joints are when the clock shows `time`, if nothing new begins before.
  std::vector<motion::MotionState> commandedAt(Time time) const;
  void advanceClock(Time now);
  void follow();
  /// How fast the clock's rate may rise, 1/s.
  double permittedRise() const;
  bool stands() const;
  bool atGoal() const;
  std::optional<TrajectoryOutcome> checkAxes() const;
  std::optional<TrajectoryOutcome> checkRefusal() const;
  std::optional<TrajectoryOutcome> checkPath() const;
  std::optional<TrajectoryOutcome> checkGoal() const;
  TrajectoryOutcome blame(motion::TrajectoryErrorCode code, std::size_t joint, double off,
                          const std::string& text) const;
  std::string dropReason(std::size_t joint) const;
  /// "0.1 rad".
  std::string distance(std::size_t joint, double way) const;
  /// Tells who waits for the end of a trajectory.
  static void tell(TrajectoryEnded& ended, const TrajectoryOutcome& outcome);
  TrajectoryOutcome replaced() const;
  void noteDropped();
  void beginNext(Time now);
  void beginStop();
  void showSent();
  void release();
  void sendSetpoints();

  config::GroupConfig config_;
  std::vector<Joint*> joints_;
  std::vector<motion::Joint> descriptions_;  // of them
  std::vector<config::JointTolerance> tolerances_;
  MotionClock clock_;
  bool starts_ = false;  // no cycle has passed since it was set
  Phase phase_ = Phase::idle;
  std::optional<motion::Trajectory> trajectory_, next_;
  TrajectoryEnded ended_, next_ended_;      // of them
  std::vector<double> positions_;           // that were commanded last
  std::vector<std::uint8_t> dropped_;       // joints that fell out of operation under way
  std::vector<std::uint8_t> next_dropped_;  // the same since next_ was planned
  std::vector<std::uint32_t> breaks_;       // of their set-points, at its beginning or stop
  std::vector<std::uint32_t> notices_;      // of the axes, when a trajectory was taken
  Time began_{};                            // the trajectory, in the time of the bus
  std::optional<std::size_t> refused_;      // the joint that did not take its set-point
  TrajectoryOutcome outcome_;               // of a stopping trajectory
};

}  // namespace cia402::bus
