// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "trajectory_checks.h"

#include <algorithm>
#include <cmath>

#include "motion/trajectory.h"

namespace cia402::motion {

namespace {

using Failure = std::optional<TrajectoryError>;

constexpr double kTolerance = 1e-6;

TrajectoryError invalidGoal(std::string sentence) {
  return {TrajectoryErrorCode::invalid_goal, std::move(sentence)};
}

std::string pointName(std::size_t index) { return "point " + std::to_string(index); }

std::string seconds(double value) { return formatNumber(value) + " s"; }

Failure checkJoints(const std::vector<Joint>& joints, const std::vector<MotionState>& commanded) {
  const auto invalid = [](std::string sentence) {
    return TrajectoryError(TrajectoryErrorCode::invalid_joints, std::move(sentence));
  };
  if (joints.empty()) return invalid("the trajectory has no joints");
  if (commanded.size() != joints.size()) {
    return invalid("the present state has " + std::to_string(commanded.size()) +
                   " joints where the trajectory has " + std::to_string(joints.size()));
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const MotionState& state = commanded[i];
    if (std::isfinite(state.position) && std::isfinite(state.velocity) &&
        std::isfinite(state.acceleration)) {
      continue;
    }
    return invalidGoal(joints[i].name +
                       ": its present position or velocity is unknown, so that there is nothing to "
                       "start from; is the axis enabled and its feedback alive?");
  }
  return {};
}

/// A quantity of a point and how it is called.
struct Quantity {
  const char* name;
  const std::vector<double>& values;
  bool required;
};

Failure checkQuantity(const std::vector<Joint>& joints, std::size_t index, const Quantity& what) {
  if (what.values.empty() && !what.required) return {};
  if (what.values.size() != joints.size()) {
    return invalidGoal(pointName(index) + " has " + std::to_string(what.values.size()) + " " +
                       what.name + " where the trajectory has " + std::to_string(joints.size()) +
                       " joints (" + joints.front().name +
                       (joints.size() > 1 ? " to " + joints.back().name : "") + ")");
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (std::isfinite(what.values[i])) continue;
    return invalidGoal(joints[i].name + ": " + pointName(index) + " has " +
                       formatNumber(what.values[i]) + " among its " + what.name +
                       "; every value must be a finite number");
  }
  return {};
}

Failure checkPoint(const std::vector<Joint>& joints, const TrajectoryPoint& point,
                   std::size_t index) {
  if (Failure failure = checkQuantity(joints, index, {"positions", point.positions, true})) {
    return failure;
  }
  if (Failure failure = checkQuantity(joints, index, {"velocities", point.velocities, false})) {
    return failure;
  }
  if (Failure failure =
          checkQuantity(joints, index, {"accelerations", point.accelerations, false})) {
    return failure;
  }
  if (!point.accelerations.empty() && point.velocities.empty()) {
    return invalidGoal(joints.front().name + ": " + pointName(index) +
                       " has accelerations without velocities; give both, or leave both out");
  }
  return {};
}

Failure checkTimes(const std::vector<TrajectoryPoint>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double time = toSeconds(points[i].time_from_start);
    if (i > 0 && points[i].time_from_start <= points[i - 1].time_from_start) {
      return invalidGoal(pointName(i) + " has time_from_start " + seconds(time) +
                         ", which is not after the " +
                         seconds(toSeconds(points[i - 1].time_from_start)) + " of " +
                         pointName(i - 1) + "; times must rise from point to point");
    }
  }
  return {};
}

Failure checkRestAtEnd(const std::vector<Joint>& joints,
                       const std::vector<TrajectoryPoint>& points) {
  if (points.empty()) return {};
  const std::vector<double>& velocities = points.back().velocities;
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    if (std::abs(velocities[i]) <= Trajectory::kRestVelocity) continue;
    return invalidGoal(joints[i].name + ": the last point (" + pointName(points.size() - 1) +
                       ") has velocity " + formatNumber(velocities[i]) + " " +
                       toString(joints[i].unit) +
                       "/s; it must be 0, for the joint is held there afterwards");
  }
  return {};
}

/// "shoulder: on the way from the present state to point 0, at 0.25 s, the ".
std::string whereabouts(const Place& place, double time_s) {
  if (place.behind_end) {
    return place.joint.name + ": behind " + pointName(place.point) + ", the last one, at " +
           seconds(place.begin_s + time_s) + " on the way to rest, the ";
  }
  const std::string from =
      place.from_present_state ? "the present state" : pointName(place.point - 1);
  return place.joint.name + ": on the way from " + from + " to " + pointName(place.point) +
         ", at " + seconds(place.begin_s + time_s) + ", the ";
}

TrajectoryError beyond(const Place& place, const Extremum& worst, const char* quantity,
                       const char* power, const std::string& limit_name, double limit) {
  const std::string unit = std::string(" ") + toString(place.joint.unit) + power;
  return invalidGoal(whereabouts(place, worst.time_s) + quantity + " reaches " +
                     formatNumber(worst.value) + unit + ", beyond the " + limit_name + " " +
                     formatNumber(limit) + unit);
}

Failure checkPosition(const SplineSegment& segment, const Place& place) {
  const JointLimits& limits = place.joint.limits;
  const double span = limits.lower && limits.upper ? *limits.upper - *limits.lower : 1.0;
  const Range range = segment.positionRange();
  const auto allowed = [&](double limit, double sign) {
    const double outside = sign * (place.present_position - limit);
    const double already = place.from_present_state ? std::max(0.0, outside) : 0.0;
    return limit + sign * (already + kTolerance * span);
  };
  if (limits.upper && range.max.value > allowed(*limits.upper, 1)) {
    return beyond(place, range.max, "position", "", "upper limit", *limits.upper);
  }
  if (limits.lower && range.min.value < allowed(*limits.lower, -1)) {
    return beyond(place, range.min, "position", "", "lower limit", *limits.lower);
  }
  return {};
}

bool exceeds(const Extremum& worst, const std::optional<double>& limit) {
  return limit && std::abs(worst.value) > *limit * (1 + kTolerance);
}

}  // namespace

std::optional<TrajectoryError> checkShape(const std::vector<Joint>& joints,
                                          const std::vector<MotionState>& commanded,
                                          const std::vector<TrajectoryPoint>& points, bool rests) {
  if (Failure failure = checkJoints(joints, commanded)) return failure;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (Failure failure = checkPoint(joints, points[i], i)) return failure;
  }
  if (Failure failure = checkTimes(points)) return failure;
  return rests ? checkRestAtEnd(joints, points) : Failure();
}

std::optional<TrajectoryError> checkRates(const std::vector<Joint>& joints,
                                          const TrajectoryPoint& point, std::size_t index,
                                          double margin) {
  const auto check = [&](const Joint& joint, const std::vector<double>& values, std::size_t i,
                         const std::optional<double>& limit, const char* what, const char* power) {
    if (values.empty() || !limit || std::abs(values[i]) <= *limit * (1 + margin)) return Failure();
    const std::string unit = std::string(" ") + toString(joint.unit) + power;
    return Failure(invalidGoal(joint.name + ": " + pointName(index) + " asks for the " + what +
                               " " + formatNumber(values[i]) + unit + ", beyond the limit " +
                               formatNumber(*limit) + unit));
  };
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointLimits& limits = joints[i].limits;
    Failure failure = check(joints[i], point.velocities, i, limits.velocity, "velocity", "/s");
    if (!failure) {
      failure =
          check(joints[i], point.accelerations, i, limits.acceleration, "acceleration", "/s^2");
    }
    if (failure) return failure;
  }
  return {};
}

std::optional<TrajectoryError> checkReach(const SplineSegment& segment, const Place& place) {
  if (!segment.isFinite()) {
    return invalidGoal(whereabouts(place, 0) + "motion of " + seconds(segment.duration()) +
                       " is too fast to be computed; check positions and time_from_start");
  }
  if (segment.surelyWithin(place.joint.limits)) return {};
  return checkPosition(segment, place);
}

std::optional<TrajectoryError> checkRates(const SplineSegment& segment, const Place& place) {
  const JointLimits& limits = place.joint.limits;
  if (segment.surelyWithin(limits)) return {};
  const Range velocity = segment.velocityRange();
  if (exceeds(velocity.largest(), limits.velocity)) {
    return beyond(place, velocity.largest(), "velocity", "/s", "limit", *limits.velocity);
  }
  const Range acceleration = segment.accelerationRange();
  if (exceeds(acceleration.largest(), limits.acceleration)) {
    return beyond(place, acceleration.largest(), "acceleration", "/s^2", "limit",
                  *limits.acceleration);
  }
  return {};
}

TrajectoryError jumpOf(const Place& place, bool at_end, double velocity) {
  const Joint& joint = place.joint;
  const std::string unit = std::string(" ") + toString(joint.unit);
  return invalidGoal(joint.name + ": " +
                     (at_end ? pointName(place.point) + " is to be reached with "
                             : "the present state is to be left with ") +
                     formatNumber(velocity) + unit + "/s at once, without " +
                     (at_end ? "braking" : "accelerating") + " by its limit " +
                     formatNumber(*joint.limits.acceleration) + unit + "/s^2");
}

}  // namespace cia402::motion
