// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/motion/trajectory_error.h"
#include "cia402_driver/motion/trajectory_point.h"
#include "motion/joint.h"
#include "motion/spline.h"
#include "motion/time_law.h"
#include "motion/trajectory_rules.h"

namespace cia402::motion {

/// What a trajectory is made of.
struct TrajectoryRequest {
  const std::vector<Joint>& joints;
  const std::vector<MotionState>& commanded;   ///< that it begins from
  const std::vector<TrajectoryPoint>& points;  ///< of the message
  std::size_t first;                           ///< of them that is ahead
  const std::vector<double>& shift;            ///< added to the positions of each joint
  double begin_s;                              ///< counted as time_from_start
  std::vector<double> durations_s;             ///< of the ways to the points that are ahead
};

struct Place;

/// The way of all joints through the points that are ahead, and when they are where.
class TrajectoryPlan {
 public:
  TrajectoryPlan(TrajectoryRequest request, const TrajectoryRules& rules);

  /// @return why it is refused
  std::optional<TrajectoryError> make();

  /// One a joint for each of durations().
  const std::vector<SplineSegment>& segments() const { return segments_; }
  /// Of the path; the law says how long they take.
  const std::vector<double>& durations() const { return durations_s_; }
  const TimeLaw& law() const { return law_; }
  /// How much later than asked the last point is reached, s.
  double delay() const { return delay_s_; }
  /// What would have been beyond a limit otherwise, in words; empty: nothing.
  const std::string& excess() const { return excess_; }
  bool endsInMotion() const { return ends_in_motion_; }
  /// Where the joints come to rest.
  std::vector<double> goal() const;

 private:
  /// What a point asks of one joint; velocity and acceleration only where it carries them.
  struct Target {
    MotionState state;
    bool has_velocity, has_acceleration;
  };
  using Failure = std::optional<TrajectoryError>;

  void readTargets();
  void fillVelocities(std::size_t joint);
  double tangent(std::size_t joint, std::size_t knot) const;
  double slope(std::size_t joint, std::size_t segment) const;
  void addRest();
  SplineSegment connect(std::size_t joint, std::size_t segment) const;
  Place placeOf(std::size_t joint, std::size_t segment, double begin_s) const;
  Failure connectAll();
  Failure findJump() const;
  Failure smooth(const TrajectoryError& excess);
  bool slowDown();
  bool bridgeFits(double duration_s);
  bool findBridge(double longest_s);
  bool approach(double longest_s);
  std::vector<double> evenTimes() const;
  double leastTime() const;
  double longest() const;
  bool single() const { return rules_.streamed && points_ == 1; }

  TrajectoryRequest request_;
  TrajectoryRules rules_;
  std::vector<Joint> joints_;  ///< with the limits that count here
  std::size_t points_;         ///< that are ahead
  bool from_rest_ = true, ends_in_motion_ = false;
  std::vector<std::vector<Target>> targets_;  ///< of all joints: the present, the points, the rest
  std::vector<double> durations_s_;
  std::vector<SplineSegment> segments_;
  Failure first_excess_;
  TimeLaw law_;
  double asked_s_ = 0.0, delay_s_ = 0.0;
  std::string excess_;
};

}  // namespace cia402::motion
