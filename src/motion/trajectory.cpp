// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/trajectory.h"

#include <algorithm>
#include <cmath>

#include "common/text.h"
#include "trajectory_checks.h"

namespace cia402::motion {

namespace {

constexpr double kTurn = 6.283185307179586;

/// What a point asks of one joint; velocity and acceleration only where it carries them.
struct Target {
  MotionState state;
  bool has_velocity, has_acceleration;
};

Target targetOf(const TrajectoryPoint& point, std::size_t joint, double shift) {
  Target target{{point.positions[joint] + shift, 0, 0},
                !point.velocities.empty(),
                !point.accelerations.empty()};
  if (target.has_velocity) target.state.velocity = point.velocities[joint];
  if (target.has_acceleration) target.state.acceleration = point.accelerations[joint];
  return target;
}

SplineSegment connect(const Target& from, const Target& to, double duration_s) {
  if (from.has_acceleration && to.has_acceleration) {
    return SplineSegment::quintic(from.state, to.state, duration_s);
  }
  if (from.has_velocity && to.has_velocity) {
    return SplineSegment::cubic(from.state, to.state, duration_s);
  }
  return SplineSegment::linear(from.state.position, to.state.position, duration_s);
}

TrajectoryError allPassed(const std::vector<TrajectoryPoint>& points, Time base, Time begin) {
  const double last = toSeconds(points.back().time_from_start);
  if (begin <= base) {
    return {TrajectoryErrorCode::invalid_goal,
            "point " + std::to_string(points.size() - 1) +
                (points.size() == 1 ? ", the only one, has" : ", the last one, has") +
                " time_from_start " + formatNumber(last) + " s: there is no time to reach it in"};
  }
  return {TrajectoryErrorCode::invalid_goal,
          "all points have passed: the trajectory should have begun " +
              formatNumber(toSeconds(begin - base)) + " s ago and its last point is at " +
              formatNumber(last) +
              " s; check the stamp and that the clocks agree (stamp 0 starts at once)"};
}

std::string quotedList(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

}  // namespace

TrajectoryResult Trajectory::create(const std::vector<Joint>& joints,
                                    const std::vector<MotionState>& commanded,
                                    const std::vector<TrajectoryPoint>& points,
                                    const TrajectoryStart& start) {
  if (auto failure = checkShape(joints, commanded, points)) return *failure;
  Trajectory result;
  result.joint_count_ = joints.size();
  result.begin_ = start.begin();
  for (const MotionState& state : commanded) result.origin_.push_back(state.position);
  result.goal_ = result.origin_;
  if (points.empty()) return result;

  const Time base = start.start_time.value_or(start.now);
  if (auto failure = result.takePointsAhead(points, base)) return *failure;
  std::vector<double> shift(joints.size(), 0.0);
  const std::vector<double>& first = points[result.dropped_points_].positions;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (!start.shortest_way || !joints[j].limits.continuous) continue;
    shift[j] = kTurn * std::round((commanded[j].position - first[j]) / kTurn);
  }
  result.segments_.reserve(result.ends_.size() * joints.size());
  std::vector<Target> from;
  for (const MotionState& state : commanded) from.push_back({state, true, true});
  Time begin = result.begin_;
  for (std::size_t s = 0; s < result.ends_.size(); ++s) {
    const std::size_t index = result.dropped_points_ + s;
    const double duration_s = toSeconds(result.ends_[s] - begin);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const Target to = targetOf(points[index], j, shift[j]);
      const SplineSegment segment = connect(from[j], to, duration_s);
      const Place place{joints[j], index, s == 0, commanded[j].position, toSeconds(begin - base)};
      if (auto failure = checkLimits(segment, place)) return *failure;
      result.segments_.push_back(segment);
      result.goal_[j] = to.state.position;
      from[j] = to;
    }
    begin = result.ends_[s];
  }
  return result;
}

std::optional<TrajectoryError> Trajectory::takePointsAhead(
    const std::vector<TrajectoryPoint>& points, Time base) {
  if (base > Time{} && points.back().time_from_start > kNever - base) {
    return TrajectoryError(TrajectoryErrorCode::invalid_goal,
                           "point " + std::to_string(points.size() - 1) +
                               " lies beyond the end of time; check time_from_start");
  }
  for (const TrajectoryPoint& point : points) {
    const Time time = base + point.time_from_start;
    if (time > begin_) ends_.push_back(time);
  }
  if (ends_.empty()) return allPassed(points, base, begin_);
  dropped_points_ = points.size() - ends_.size();
  return {};
}

std::size_t Trajectory::segmentAt(Time time) const {
  return static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), time) -
                                  ends_.begin());
}

MotionState Trajectory::sampleSegment(std::size_t segment, std::size_t joint, Time time) const {
  return segments_[segment * joint_count_ + joint].sample(toSeconds(time - beginOf(segment)));
}

MotionState Trajectory::rest(std::size_t joint, Time time) const {
  return {time < begin_ ? origin_[joint] : goal_[joint], 0, 0};
}

MotionState Trajectory::sample(std::size_t joint, Time time) const {
  if (time < begin_ || finished(time)) return rest(joint, time);
  return sampleSegment(segmentAt(time), joint, time);
}

void Trajectory::sample(Time time, std::vector<MotionState>& states) const {
  const std::size_t count = std::min(states.size(), joint_count_);
  const bool moving = time >= begin_ && !finished(time);
  const std::size_t segment = moving ? segmentAt(time) : 0;
  for (std::size_t j = 0; j < count; ++j) {
    states[j] = moving ? sampleSegment(segment, j, time) : rest(j, time);
  }
}

void Trajectory::samplePositions(Time time, std::vector<double>& positions) const {
  const std::size_t count = std::min(positions.size(), joint_count_);
  if (time < begin_ || finished(time)) {
    const std::vector<double>& rest = time < begin_ ? origin_ : goal_;
    std::copy_n(rest.begin(), count, positions.begin());
    return;
  }
  const std::size_t segment = segmentAt(time);
  const double since_s = toSeconds(time - beginOf(segment));
  const SplineSegment* const joints = &segments_[segment * joint_count_];
  for (std::size_t j = 0; j < count; ++j) positions[j] = joints[j].position(since_s);
}

Result<std::vector<JointPlace>> matchJoints(const std::vector<Joint>& joints,
                                            const std::vector<std::string>& names, bool partial) {
  std::vector<JointPlace> places;
  std::vector<std::string> missing, twice, unknown;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& joint = joints[i];
    const auto found = std::find(names.begin(), names.end(), joint.name);
    const auto count = std::count(names.begin(), names.end(), joint.name);
    if (count > 0) places.push_back({i, static_cast<std::size_t>(found - names.begin())});
    if (count == 0 && (!partial || names.empty())) missing.push_back(joint.name);
    if (count > 1) twice.push_back(joint.name);
  }
  for (const std::string& name : names) {
    const bool known = std::any_of(joints.begin(), joints.end(),
                                   [&name](const Joint& joint) { return joint.name == name; });
    if (!known) unknown.push_back(name);
  }
  std::string sentence;
  const auto mention = [&sentence](const char* what, const std::vector<std::string>& which) {
    if (which.empty()) return;
    append(sentence, what + quotedList(which));
  };
  mention("the group has no joint ", unknown);
  mention("the trajectory lacks joint ", missing);
  mention("the trajectory names more than once ", twice);
  if (sentence.empty()) return places;
  std::vector<std::string> all;
  for (const Joint& joint : joints) all.push_back(joint.name);
  return Error{sentence + "; the group's joints are " + quotedList(all)};
}

}  // namespace cia402::motion
