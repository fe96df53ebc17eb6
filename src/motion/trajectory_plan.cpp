// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/trajectory_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/trajectory.h"
#include "motion/trajectory_checks.h"

namespace cia402::motion {
namespace {

/// What points may be beyond a limit by without being refused: rounding of whoever planned them.
constexpr double kPointMargin = 0.01;
constexpr double kGrowth = 1.1;
constexpr int kHalvings = 6;
constexpr double kLongestApproach = 600.0;  // s

bool atRest(double velocity) { return std::abs(velocity) <= Trajectory::kRestVelocity; }

}  // namespace

TrajectoryPlan::TrajectoryPlan(TrajectoryRequest request, const TrajectoryRules& rules)
    : request_(std::move(request)),
      rules_(rules),
      joints_(request_.joints),
      points_(request_.durations_s.size()),
      durations_s_(request_.durations_s) {
  for (Joint& joint : joints_) {
    if (joint.limits.acceleration) *joint.limits.acceleration *= 1.0 + rules.margin;
  }
  for (const MotionState& state : request_.commanded) {
    from_rest_ = from_rest_ && atRest(state.velocity);
  }
  for (double duration_s : durations_s_) asked_s_ += duration_s;
}

std::optional<TrajectoryError> TrajectoryPlan::make() {
  for (std::size_t i = 0; i < points_ && !rules_.strict; ++i) {
    const double margin = std::max(kPointMargin, rules_.margin);
    const std::size_t index = request_.first + i;
    if (Failure failure = checkRates(request_.joints, request_.points[index], index, margin)) {
      return failure;
    }
  }
  readTargets();
  for (std::size_t j = 0; j < joints_.size(); ++j) fillVelocities(j);
  if (rules_.streamed) addRest();
  if (Failure failure = connectAll()) return failure;
  if (!first_excess_) first_excess_ = findJump();
  if (!first_excess_) return {};
  const TrajectoryError excess = *first_excess_;
  return rules_.strict ? excess : smooth(excess);
}

void TrajectoryPlan::readTargets() {
  std::vector<Target> present;
  for (const MotionState& state : request_.commanded) present.push_back({state, true, true});
  targets_.push_back(std::move(present));
  for (std::size_t i = request_.first; i < request_.points.size(); ++i) {
    const TrajectoryPoint& point = request_.points[i];
    std::vector<Target> targets;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      Target target{{point.positions[j] + request_.shift[j], 0, 0},
                    !point.velocities.empty(),
                    !point.accelerations.empty()};
      if (target.has_velocity) target.state.velocity = point.velocities[j];
      if (target.has_acceleration) target.state.acceleration = point.accelerations[j];
      targets.push_back(target);
    }
    targets_.push_back(std::move(targets));
  }
}

/// A joint that may not change its velocity at once passes points that do not say with which one
/// so that it neither swings beyond them nor turns back between them.
void TrajectoryPlan::fillVelocities(std::size_t joint) {
  if (!joints_[joint].limits.acceleration) return;
  const bool straight_away = from_rest_ && !targets_[1][joint].has_velocity;
  for (std::size_t knot = 1; knot < targets_.size(); ++knot) {
    Target& target = targets_[knot][joint];
    if (!target.has_velocity) target.state.velocity = tangent(joint, knot);
    target.has_velocity = true;
  }
  if (straight_away) targets_[0][joint].state.velocity = slope(joint, 1);
}

/// The mean velocity on the way to a point.
double TrajectoryPlan::slope(std::size_t joint, std::size_t segment) const {
  const double way =
      targets_[segment][joint].state.position - targets_[segment - 1][joint].state.position;
  return way / durations_s_[segment - 1];
}

/// The harmonic mean of the slopes on both sides, weighted as F. N. Fritsch and J. Butland do. At
/// the end straight on: how fast that is passed is up to the time law.
double TrajectoryPlan::tangent(std::size_t joint, std::size_t knot) const {
  const double before = slope(joint, knot);
  if (knot == points_) return from_rest_ || points_ > 1 ? before : 0.0;
  const double behind = slope(joint, knot + 1);
  if (!(before * behind > 0.0)) return 0.0;
  const double h0 = durations_s_[knot - 1], h1 = durations_s_[knot];
  const double w0 = 2.0 * h1 + h0, w1 = h1 + 2.0 * h0;
  return (w0 + w1) / (w0 / before + w1 / behind);
}

/// Behind a last point that is passed in motion: straight on for a while, then to rest, all joints
/// in the same time.
void TrajectoryPlan::addRest() {
  if (request_.points.back().velocities.empty()) return;
  double braking_s = 0.0;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    const double velocity = std::abs(targets_[points_][j].state.velocity);
    if (atRest(velocity)) continue;
    braking_s =
        std::max(braking_s, velocity / joint.limits.acceleration.value_or(joint.deceleration));
  }
  if (braking_s == 0.0) return;
  ends_in_motion_ = true;
  std::vector<Target> coasted = targets_[points_];
  for (Target& target : coasted) {
    target.state.position += rules_.coast_s * target.state.velocity;
    target.has_acceleration = false;
  }
  std::vector<Target> rest = coasted;
  for (Target& target : rest) {
    target.state.position += 0.5 * braking_s * target.state.velocity;
    target.state.velocity = 0.0;
  }
  targets_.push_back(std::move(coasted));
  targets_.push_back(std::move(rest));
  durations_s_.push_back(std::max(rules_.coast_s, 1e-6));
  durations_s_.push_back(braking_s);
}

SplineSegment TrajectoryPlan::connect(std::size_t joint, std::size_t segment) const {
  const Target& from = targets_[segment][joint];
  const Target& to = targets_[segment + 1][joint];
  const double duration_s = durations_s_[segment];
  if (from.has_acceleration && to.has_acceleration) {
    return SplineSegment::quintic(from.state, to.state, duration_s);
  }
  if (from.has_velocity && to.has_velocity) {
    return SplineSegment::cubic(from.state, to.state, duration_s);
  }
  return SplineSegment::linear(from.state.position, to.state.position, duration_s);
}

Place TrajectoryPlan::placeOf(std::size_t joint, std::size_t segment, double begin_s) const {
  const bool behind_end = segment >= points_;
  const std::size_t point = request_.first + std::min(segment, points_ - 1);
  return {joints_[joint], point,     segment == 0, request_.commanded[joint].position,
          begin_s,        behind_end};
}

/// @return what cannot be mended by more time
TrajectoryPlan::Failure TrajectoryPlan::connectAll() {
  segments_.clear();
  first_excess_.reset();
  double begin_s = request_.begin_s;
  for (std::size_t s = 0; s < durations_s_.size(); ++s) {
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      segments_.push_back(connect(j, s));
      const Place place = placeOf(j, s, begin_s);
      const bool bridge = s == 0 && single() && !from_rest_;  // which may get another duration
      Failure failure = checkReach(segments_.back(), place);
      if (failure && !bridge) return failure;
      if (!failure) failure = checkRates(segments_.back(), place);
      if (failure && !first_excess_) first_excess_ = std::move(failure);
      if (first_excess_ && rules_.strict) return first_excess_;
    }
    begin_s += durations_s_[s];
  }
  return {};
}

/// Where a joint would have to leave its rest at once, or to come to it.
TrajectoryPlan::Failure TrajectoryPlan::findJump() const {
  const std::size_t last = durations_s_.size() - 1;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (!joints_[j].limits.acceleration) continue;
    const double begins = targets_.front()[j].state.velocity,
                 ends = targets_.back()[j].state.velocity;
    if (from_rest_ && !atRest(begins)) return jumpOf(placeOf(j, 0, 0.0), false, begins);
    if (!atRest(ends)) return jumpOf(placeOf(j, last, 0.0), true, ends);
  }
  return {};
}

double TrajectoryPlan::longest() const {
  return asked_s_ * (1.0 + rules_.longer_share) + rules_.longer_s;
}

TrajectoryPlan::Failure TrajectoryPlan::smooth(const TrajectoryError& excess) {
  const double longest_s = single() ? kLongestApproach : longest();
  const bool found = single()     ? approach(longest_s)
                     : from_rest_ ? slowDown()
                                  : findBridge(longest_s);
  double lasts_s = law_.delay();
  for (std::size_t s = 0; s < points_; ++s) lasts_s += durations_s_[s];
  TrajectoryError refused = excess;
  if (!found) {
    refused.message += "; the joints move already, and cannot be slowed down in time on that way";
    return refused;
  }
  delay_s_ = lasts_s - asked_s_;
  if (lasts_s > longest_s) {
    refused.message += "; within the limits it takes " + formatNumber(lasts_s) + " s instead of " +
                       formatNumber(asked_s_) + " s, and may take " + formatNumber(longest_s) +
                       " s";
    return refused;
  }
  excess_ = excess.message;
  return {};
}

bool TrajectoryPlan::slowDown() {
  std::vector<JointLimits> limits;
  for (const Joint& joint : joints_) limits.push_back(joint.limits);
  const std::optional<TimeLaw> law = TimeLaw::of({segments_, limits, from_rest_});
  if (law) law_ = *law;
  return law.has_value();
}

/// The way to the first point in another time, and whether all joints keep their limits on it.
bool TrajectoryPlan::bridgeFits(double duration_s) {
  durations_s_.front() = duration_s;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    segments_[j] = connect(j, 0);
    const Place place = placeOf(j, 0, request_.begin_s);
    if (checkReach(segments_[j], place) || checkRates(segments_[j], place)) return false;
  }
  return true;
}

/// In which each joint that goes on behind the first point would change its velocity evenly up to
/// it, the nearest to what is asked for first.
std::vector<double> TrajectoryPlan::evenTimes() const {
  std::vector<double> times;
  const double asked_s = request_.durations_s.front();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const MotionState &from = targets_[0][j].state, &to = targets_[1][j].state;
    const double even_s = 2.0 * (to.position - from.position) / (from.velocity + to.velocity);
    const bool goes_on = from.velocity * to.velocity > 0.0;
    if (goes_on && std::isfinite(even_s) && even_s > 1e-6) times.push_back(even_s);
  }
  std::sort(times.begin(), times.end(), [asked_s](double a, double b) {
    return std::abs(std::log(a / asked_s)) < std::abs(std::log(b / asked_s));
  });
  return times;
}

/// The first point is not reached in less, on any way.
double TrajectoryPlan::leastTime() const {
  double least_s = 0.0;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const JointLimits& limits = joints_[j].limits;
    const MotionState &from = targets_[0][j].state, &to = targets_[1][j].state;
    const double way = std::abs(to.position - from.position);
    const double change = std::abs(to.velocity - from.velocity);
    if (limits.velocity) least_s = std::max(least_s, way / *limits.velocity);
    if (limits.acceleration && !from_rest_)
      least_s = std::max(least_s, change / *limits.acceleration);
  }
  return least_s;
}

/// A motion that is under way takes as much longer to the first point as it needs.
bool TrajectoryPlan::findBridge(double longest_s) {
  const double asked_s = request_.durations_s.front();
  const double most_s = single() ? longest_s : asked_s + longest_s - asked_s_;
  const auto fits = [this](double duration_s) { return bridgeFits(duration_s) && slowDown(); };
  if (fits(asked_s)) return true;
  for (double even_s : evenTimes()) {
    const bool longer = even_s >= asked_s || single();
    if (longer && even_s <= most_s && fits(even_s)) return true;
  }
  double too_short_s = std::max({asked_s, leastTime(), 1e-4});
  for (double long_s = too_short_s; long_s <= most_s * kGrowth; long_s *= kGrowth) {
    const double tried_s = std::min(long_s, most_s);
    if (!fits(tried_s)) {
      too_short_s = tried_s;
      continue;
    }
    double fits_s = tried_s;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle_s = 0.5 * (too_short_s + fits_s);
      (fits(middle_s) ? fits_s : too_short_s) = middle_s;
    }
    return fits(fits_s);
  }
  return false;
}

/// To a single point, however near.
bool TrajectoryPlan::approach(double longest_s) {
  if (!from_rest_) return findBridge(longest_s);
  const double least_s = leastTime();
  if (durations_s_.front() < least_s) {
    const double ratio = durations_s_.front() / least_s;
    for (std::size_t j = 0; j < joints_.size(); ++j) {  // the same way, drawn out
      if (!request_.points.back().velocities.empty()) continue;
      targets_[0][j].state.velocity *= ratio;
      if (points_ + 1 == targets_.size()) targets_[1][j].state.velocity *= ratio;
    }
    durations_s_.front() = least_s;
    if (connectAll()) return false;
  }
  return slowDown();
}

std::vector<double> TrajectoryPlan::goal() const {
  std::vector<double> goal;
  for (const Target& target : targets_.back()) goal.push_back(target.state.position);
  return goal;
}

}  // namespace cia402::motion
