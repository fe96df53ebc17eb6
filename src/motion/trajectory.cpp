// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/trajectory.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "common/text.h"
#include "motion/trajectory_checks.h"
#include "motion/trajectory_plan.h"

namespace cia402::motion {

namespace {

constexpr double kTurn = 6.283185307179586;
constexpr double kHalfTurn = 0.5 * kTurn;
constexpr double kEqual = 1e-9;  // rad: two ways that differ by no more are as long as each other

/// Whole turns, rad, that take `position` to where it is nearest to `from`. Where both ways there
/// are half a turn it is the one that was asked for, as in ros_controllers' wraparoundJointOffset.
double turnsTo(double from, double position) {
  const double asked = position - from;
  double way = std::remainder(asked, kTurn);
  if (std::abs(std::abs(way) - kHalfTurn) < kEqual) way = std::copysign(kHalfTurn, asked);
  return kTurn * std::round((way - asked) / kTurn);
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
                                    const TrajectoryStart& start, const TrajectoryRules& rules) {
  if (auto failure = checkShape(joints, commanded, points, !rules.streamed)) return *failure;
  Trajectory result;
  result.joint_count_ = joints.size();
  result.begin_ = result.end_ = start.begin();
  for (const MotionState& state : commanded) result.origin_.push_back(state.position);
  result.goal_ = result.origin_;
  if (points.empty()) return result;

  const Time base = start.start_time.value_or(start.now);
  std::vector<double> durations_s;
  if (auto failure = result.takePointsAhead(points, base, durations_s)) return *failure;
  std::vector<double> shift(joints.size(), 0.0);
  const std::vector<double>& first = points[result.dropped_points_].positions;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (!start.shortest_way || !joints[j].limits.continuous) continue;
    shift[j] = turnsTo(commanded[j].position, first[j]);
  }
  TrajectoryPlan plan({joints, commanded, points, result.dropped_points_, shift,
                       toSeconds(result.begin_ - base), std::move(durations_s)},
                      rules);
  if (auto failure = plan.make()) return *failure;
  result.take(plan);
  return result;
}

std::optional<TrajectoryError> Trajectory::takePointsAhead(
    const std::vector<TrajectoryPoint>& points, Time base, std::vector<double>& durations_s) {
  if (base > Time{} && points.back().time_from_start > kNever - base) {
    return TrajectoryError(TrajectoryErrorCode::invalid_goal,
                           "point " + std::to_string(points.size() - 1) +
                               " lies beyond the end of time; check time_from_start");
  }
  for (const TrajectoryPoint& point : points) {
    const Time time = base + point.time_from_start;
    if (time <= begin_) continue;
    durations_s.push_back(toSeconds(time - end_));
    end_ = time;
  }
  if (durations_s.empty()) return allPassed(points, base, begin_);
  dropped_points_ = points.size() - durations_s.size();
  return {};
}

void Trajectory::take(const TrajectoryPlan& plan) {
  segments_ = plan.segments();
  goal_ = plan.goal();
  law_ = plan.law();
  delay_s_ = plan.delay();
  excess_ = plan.excess();
  ends_in_motion_ = plan.endsInMotion();
  double along_s = 0.0;
  for (double duration_s : plan.durations()) ends_s_.push_back(along_s += duration_s);
  const bool as_asked = excess_.empty() && !ends_in_motion_;
  if (!as_asked) end_ = begin_ + fromSeconds(along_s + law_.delay());
}

Trajectory::PathPlace Trajectory::placeAt(double along_s) const {
  const auto found = std::upper_bound(ends_s_.begin(), ends_s_.end(), along_s);
  const auto segment = static_cast<std::size_t>(
      std::min(found - ends_s_.begin(), static_cast<std::ptrdiff_t>(ends_s_.size()) - 1));
  return {segment, along_s - (segment == 0 ? 0.0 : ends_s_[segment - 1])};
}

MotionState Trajectory::rest(std::size_t joint, Time time) const {
  return {time < begin_ ? origin_[joint] : goal_[joint], 0, 0};
}

MotionState Trajectory::sample(std::size_t joint, Time time) const {
  if (time < begin_ || finished(time)) return rest(joint, time);
  const TimeLaw::Moment moment = law_.at(toSeconds(time - begin_));
  const PathPlace place = placeAt(moment.along_s);
  MotionState state = segments_[place.segment * joint_count_ + joint].sample(place.since_s);
  state.acceleration =
      state.acceleration * moment.rate * moment.rate + state.velocity * moment.change;
  state.velocity *= moment.rate;
  return state;
}

void Trajectory::sample(Time time, std::vector<MotionState>& states) const {
  const std::size_t count = std::min(states.size(), joint_count_);
  for (std::size_t j = 0; j < count; ++j) states[j] = sample(j, time);
}

void Trajectory::samplePositions(Time time, std::vector<double>& positions) const {
  const std::size_t count = std::min(positions.size(), joint_count_);
  if (time < begin_ || finished(time)) {
    const std::vector<double>& rest = time < begin_ ? origin_ : goal_;
    std::copy_n(rest.begin(), count, positions.begin());
    return;
  }
  const PathPlace place = placeAt(law_.at(toSeconds(time - begin_)).along_s);
  const SplineSegment* const joints = &segments_[place.segment * joint_count_];
  for (std::size_t j = 0; j < count; ++j) positions[j] = joints[j].position(place.since_s);
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
