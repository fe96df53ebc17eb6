// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bus/command.h"
#include "bus/joint.h"
#include "bus/motion_clock.h"
#include "bus/trajectory_run.h"
#include "cia402_driver/bus/trajectory_outcome.h"
#include "cia402_driver/common/result.h"
#include "config/robot.h"
#include "motion/trajectory.h"

namespace cia402::bus {

/// A set of joints that follow trajectories together, on one clock. A new trajectory takes its
/// joints over smoothly from where they are; joints that it does not name go on with what they do.
/// Not to be moved once something was started.
class Group {
 public:
  /// @param joints those of config.joints, in that order; must outlive the group.
  /// @param cycle period of the bus
  Group(config::GroupConfig config, std::vector<Joint*> joints, Duration cycle);

  const config::GroupConfig& config() const { return config_; }
  /// Those of its configuration, in that order.
  const std::vector<Joint*>& joints() const { return joints_; }
  /// Takes over what may change in motion: tolerances, times, what concerns some joints alone. It
  /// counts at once, for what is being followed, too, as far as that has none of its own. Takes no
  /// memory: `next` gets what was there before.
  void adopt(config::GroupConfig& next);
  /// Its joints have got other limits. @pre they are at rest
  void adoptLimits();

  /// Checks a trajectory and takes it over; without points, stops. On an error nothing changes.
  TrajectoryOutcome start(const TrajectoryCommand& command, Time now);
  /// Stops the joints of the trajectory of that number, where it runs or waits.
  void cancel(std::uint64_t id, Time now);
  /// Brings all joints to rest and ends their trajectories with `why`.
  void stop(const TrajectoryOutcome& why);
  /// Gives the axes their set-points of this cycle. @return how trajectories ended, in the cycle in
  /// which they did; valid until the next call. Not inlined: it would push apart what each of the
  /// more axes does there.
  [[gnu::noinline]] const std::vector<TrajectoryOutcome>& step(Time now);

  /// A trajectory is being followed, or its beginning or end is awaited.
  bool executing() const;
  /// Joints are being brought to rest.
  bool stopping() const;
  /// Commanded states, one a joint; valid while executing or stopping. Made on demand: allocates.
  std::vector<motion::MotionState> commanded() const;
  /// Where a joint of the group is commanded to be at `then`, a time of the bus, and how fast, by
  /// all that was accepted until now; see PlannedStateCommand.
  Result<motion::MotionState> stateAt(const Joint& joint, Time then, Time now) const;

 private:
  std::string refusal(const std::vector<Joint*>& joints) const;
  /// Which joint is named without another one of its coupling, in words; empty if none is.
  std::string tornApart(const std::vector<Joint*>& joints) const;
  /// Where a joint is when the clock shows `time`, if nothing new begins before.
  motion::MotionState commandedAt(const Joint& joint, Time time) const;
  motion::TrajectoryRules rulesOf(const TrajectoryCommand& command) const;
  TrajectoryOutcome refuse(motion::TrajectoryErrorCode code, const std::string& why) const;
  TrajectoryOutcome startStop(const TrajectoryCommand& command, const std::vector<Joint*>& joints,
                              Time now);
  void add(TrajectoryRun run, Time now);
  void beginDue(Time now);
  void stop(TrajectoryRun& run, const TrajectoryOutcome& why);
  /// Forgets what has ended; joints that nothing else waits for are free.
  void sweep();
  void advanceClock(Time now);
  /// How fast the clock's rate may rise, 1/s.
  double permittedRise() const;
  /// What one joint cannot follow ends the motion of all.
  void stopFailed();
  void stepRun(TrajectoryRun& run, Time now);

  config::GroupConfig config_;
  std::vector<Joint*> joints_;
  std::vector<motion::Joint> descriptions_;  // of them
  Duration cycle_;
  MotionClock clock_;
  bool starts_ = false;                   // no cycle has passed since it was set
  TrajectoryOutcome replaced_;            // of what a newer trajectory takes over, worded once
  std::vector<TrajectoryRun> runs_;       // in the order in which they were accepted
  std::vector<TrajectoryOutcome> ended_;  // in this cycle
};

}  // namespace cia402::bus
