// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/group.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/text.h"

namespace cia402::bus {
namespace {

using motion::TrajectoryErrorCode;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kArrived = 0.01;  // rad or m; "reached" where no goal tolerance is configured

std::vector<motion::TrajectoryPoint> reorder(const std::vector<motion::TrajectoryPoint>& points,
                                             const std::vector<std::size_t>& order) {
  const auto pick = [&order](const std::vector<double>& values) {
    if (values.size() != order.size()) return values;  // absent, or an error that create() words
    std::vector<double> picked;
    for (std::size_t from : order) picked.push_back(values[from]);
    return picked;
  };
  std::vector<motion::TrajectoryPoint> ordered;
  for (const motion::TrajectoryPoint& point : points) {
    ordered.push_back({pick(point.positions), pick(point.velocities), pick(point.accelerations),
                       point.time_from_start});
  }
  return ordered;
}

TrajectoryOutcome refused(TrajectoryErrorCode code, const std::string& why) {
  return {code, why, TrajectoryEnd::refused, {}};
}

}  // namespace

Group::Group(config::GroupConfig config, std::vector<Joint*> joints, Duration cycle)
    : config_(std::move(config)),
      joints_(std::move(joints)),
      clock_(cycle),
      positions_(joints_.size()),
      dropped_(joints_.size(), 0),
      next_dropped_(joints_.size(), 0),
      breaks_(joints_.size(), 0),
      notices_(joints_.size(), 0) {
  for (const Joint* joint : joints_) {
    descriptions_.push_back(joint->description());
    const auto tolerance = config_.tolerances.find(joint->name());
    tolerances_.push_back(tolerance == config_.tolerances.end() ? config::JointTolerance()
                                                                : tolerance->second);
  }
}

std::string Group::refusal() const {
  std::string all;
  for (const Joint* joint : joints_) {
    const std::string reason = joint->refusal(config_.name);
    if (!reason.empty()) append(all, reason);
  }
  return all;
}

std::vector<motion::MotionState> Group::commandedAt(Time time) const {
  std::vector<motion::MotionState> states(joints_.size());
  // In the time of the clock, also where that lags: what comes next is given out by the same clock.
  const bool planned = phase_ == Phase::following;
  if (planned) trajectory_->sample(time, states);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (planned && dropped_[i] == 0) continue;
    const auto sent = joints_[i]->sent().expected(time - clock_.time());
    states[i] = {sent.position, sent.velocity, 0.0};
  }
  return states;
}

TrajectoryOutcome Group::start(const std::vector<std::string>& names,
                               const std::vector<motion::TrajectoryPoint>& points,
                               std::optional<Time> start_time, Time now, TrajectoryEnded ended) {
  if (points.empty()) {
    stop({TrajectoryErrorCode::successful, config_.name + ": stopped by an empty trajectory"});
    return {TrajectoryErrorCode::successful, config_.name + ": stopping"};
  }
  const auto order = motion::matchJoints(descriptions_, names);
  if (!order) return refused(TrajectoryErrorCode::invalid_joints, order.error().message);
  const std::string why_not = refusal();
  if (!why_not.empty()) {
    return refused(TrajectoryErrorCode::invalid_goal,
                   config_.name + ": trajectory refused: " + why_not);
  }
  if (phase_ == Phase::idle) {
    clock_.set(now);
    starts_ = true;
  }
  motion::TrajectoryStart start;
  start.now = clock_.time();
  if (start_time) start.start_time = clock_.at(*start_time, now);
  start.shortest_way = true;
  auto trajectory = motion::Trajectory::create(descriptions_, commandedAt(start.begin()),
                                               reorder(points, *order), start);
  if (!trajectory) return refused(trajectory.error().code, trajectory.error().message);
  tell(next_ended_, replaced());
  next_ = std::move(trajectory).value();
  next_ended_ = std::move(ended);
  std::fill(next_dropped_.begin(), next_dropped_.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    breaks_[i] = joints_[i]->sent().breaks();
    notices_[i] = joints_[i]->noticeCount();
  }
  if (phase_ == Phase::idle) {
    showSent();
    beginNext(now);
  }
  for (Joint* joint : joints_) joint->follow(&config_.name);
  return {TrajectoryErrorCode::successful, config_.name + ": trajectory accepted"};
}

void Group::beginNext(Time now) {
  began_ = now;
  tell(ended_, replaced());
  trajectory_ = std::move(next_);
  ended_ = std::exchange(next_ended_, nullptr);
  next_.reset();
  phase_ = Phase::following;
  refused_.reset();
  dropped_ = next_dropped_;
}

/// A joint that was not ready for a while, or whose set-points were ended by anything else (another
/// zero of its positions, a motor that stands), is not where its trajectories were planned from.
void Group::noteDropped() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& joint = *joints_[i];
    if (!joint.ready() || joint.sent().breaks() != breaks_[i]) {
      dropped_[i] = next_dropped_[i] = 1;
    }
  }
}

void Group::stop(const TrajectoryOutcome& why) {
  if (!executing()) return;
  outcome_ = why;
  outcome_.end = TrajectoryEnd::stopped;
  if (phase_ == Phase::following) beginStop();
  next_.reset();
  tell(next_ended_, outcome_);
}

void Group::tell(TrajectoryEnded& ended, const TrajectoryOutcome& outcome) {
  if (const TrajectoryEnded once = std::exchange(ended, nullptr)) once(outcome);
}

TrajectoryOutcome Group::replaced() const {
  return {TrajectoryErrorCode::successful,
          config_.name + ": replaced by a newer trajectory",
          TrajectoryEnd::replaced,
          {}};
}

void Group::beginStop() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (dropped_[i] == 0) joints_[i]->stop();
    breaks_[i] = joints_[i]->sent().breaks();
  }
  trajectory_.reset();
  next_.reset();
  tell(next_ended_, outcome_);
  phase_ = Phase::stopping;
}

/// The joints' own accelerations come with the square of the rate, so that both together keep the
/// limit: rise * velocity + rate² * acceleration.
double Group::permittedRise() const {
  constexpr double kLeast = 0.1;  // of the limit, where the trajectory takes all of it
  const double rate = clock_.rate();
  double rise = 1e9;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const motion::MotionState state = trajectory_->sample(i, clock_.time());
    const double limit = joints_[i]->stopDeceleration();
    const double left = limit - rate * rate * std::abs(state.acceleration);
    const double speed = std::max(std::abs(state.velocity), 1e-9);
    rise = std::min(rise, std::max(left, kLeast * limit) / speed);
  }
  return rise;
}

void Group::advanceClock(Time now) {
  const bool waits = phase_ == Phase::following && clock_.time() < trajectory_->startTime();
  if (waits || phase_ == Phase::stopping) {
    const Time next = next_ ? next_->startTime() : kNever;
    clock_.idle(now, waits ? std::min(next, trajectory_->startTime()) : next);
  } else if (std::exchange(starts_, false)) {
    clock_.begin(now);
  } else {
    clock_.cycle(now, joints_.front()->late());
    clock_.advance(clock_.rate() == 1.0 ? 1.0 : permittedRise());
  }
}

void Group::follow() {
  trajectory_->samplePositions(clock_.time(), positions_);
  sendSetpoints();
}

std::vector<motion::MotionState> Group::commanded() const {
  std::vector<motion::MotionState> states(joints_.size());
  const bool planned = phase_ == Phase::following;
  if (planned) trajectory_->sample(clock_.time(), states);
  const double rate = clock_.rate();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    states[i].position = positions_[i];
    states[i].velocity = planned ? states[i].velocity * rate : joints_[i]->sent().velocity();
    states[i].acceleration *= rate * rate;
  }
  return states;
}

void Group::showSent() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    positions_[i] = joints_[i]->sent().value();
  }
}

bool Group::stands() const {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (dropped_[i] == 0 && !joints_[i]->sent().atRest()) return false;
  }
  return true;
}

/// The goal was sent already: given once more, the set-points are at rest there.
bool Group::atGoal() const {
  if (!trajectory_->finished(clock_.time())) return false;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (dropped_[i] == 0 && joints_[i]->sent().value() != trajectory_->goal()[i]) return false;
  }
  return true;
}

std::optional<TrajectoryOutcome> Group::step(Time now) {
  if (phase_ == Phase::idle) return std::nullopt;
  noteDropped();
  advanceClock(now);
  if (next_ && clock_.time() >= next_->startTime()) beginNext(now);
  if (phase_ == Phase::following) {
    auto ended = checkRefusal();  // which ends the axis' set-points, too
    if (!ended) ended = checkAxes();
    if (!ended) ended = checkPath();
    if (ended) {
      outcome_ = *ended;
      beginStop();
    }
  }
  if (phase_ == Phase::following) {
    const bool at_goal = !next_ && atGoal();
    follow();
    if (!at_goal) return std::nullopt;
    const auto reached = checkGoal();
    if (!reached) return std::nullopt;
    outcome_ = *reached;
    release();
    return outcome_;
  }
  showSent();
  if (next_ || !stands()) return std::nullopt;
  release();
  return outcome_;
}

void Group::sendSetpoints() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    // An axis that fell out of operation holds or stops by itself; the others go on as configured.
    // Enabled again, it must not jump to where the trajectory is by now.
    if (dropped_[i] == 0 && !joints_[i]->give(positions_[i])) refused_ = i;
  }
}

void Group::release() {
  for (Joint* joint : joints_) joint->follow(nullptr);
  trajectory_.reset();
  phase_ = Phase::idle;
  tell(ended_, outcome_);
}

TrajectoryOutcome Group::blame(TrajectoryErrorCode code, std::size_t joint, double off,
                               const std::string& text) const {
  return {code, config_.name + text, TrajectoryEnd::failed, joints_[joint]->name(), off};
}

std::optional<TrajectoryOutcome> Group::checkAxes() const {
  bool any_ready = false;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (dropped_[i] == 0) {
      any_ready = true;
    } else if (config_.stop_group_on_fault) {
      return blame(TrajectoryErrorCode::path_tolerance_violated, i, kNothing,
                   ": trajectory stopped: " + dropReason(i));
    }
  }
  if (any_ready) return std::nullopt;
  return TrajectoryOutcome{TrajectoryErrorCode::path_tolerance_violated,
                           config_.name + ": trajectory stopped: no joint is enabled any more",
                           TrajectoryEnd::failed,
                           {}};
}

std::string Group::dropReason(std::size_t joint) const {
  return joints_[joint]->trouble(notices_[joint]);
}

std::optional<TrajectoryOutcome> Group::checkRefusal() const {
  if (!refused_) return std::nullopt;
  return blame(TrajectoryErrorCode::path_tolerance_violated, *refused_, kNothing,
               ": trajectory stopped: " + joints_[*refused_]->who() +
                   " refused a set-point: it does not fit the drive or is beyond the "
                   "joint's limits");
}

std::optional<TrajectoryOutcome> Group::checkPath() const {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (tolerances_[i].trajectory <= 0.0 || dropped_[i] != 0) continue;
    const double error = std::abs(positions_[i] - joints_[i]->position());
    if (began_ < joints_[i]->stamp() && error > tolerances_[i].trajectory) {
      return blame(TrajectoryErrorCode::path_tolerance_violated, i, error,
                   ": trajectory stopped: " + joints_[i]->who() + " is " + distance(i, error) +
                       " off its path, the tolerance is " +
                       motion::formatNumber(tolerances_[i].trajectory));
    }
  }
  return std::nullopt;
}

std::string Group::distance(std::size_t joint, double way) const {
  return motion::formatNumber(way) + " " + motion::toString(descriptions_[joint].unit);
}

std::optional<TrajectoryOutcome> Group::checkGoal() const {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (dropped_[i] == 0) continue;
    return blame(TrajectoryErrorCode::goal_tolerance_violated, i, kNothing,
                 ": goal missed: " + dropReason(i));
  }
  std::string away;  // without a tolerance that is no failure, but it is told
  TrajectoryOutcome reached{TrajectoryErrorCode::successful, config_.name + ": goal reached"};
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const bool judged = tolerances_[i].goal > 0.0;
    const double error = std::abs(trajectory_->goal()[i] - joints_[i]->position());
    if (error <= (judged ? tolerances_[i].goal : kArrived)) continue;
    if (clock_.time() < trajectory_->endTime() + fromSeconds(config_.goal_time)) {
      return std::nullopt;
    }
    const std::string where = joints_[i]->who() + " is " + distance(i, error) + " away";
    if (judged) {
      return blame(TrajectoryErrorCode::goal_tolerance_violated, i, error,
                   ": goal missed: " + where + " after " + motion::formatNumber(config_.goal_time) +
                       " s, the tolerance is " + motion::formatNumber(tolerances_[i].goal));
    }
    append(away, where, ", ");
    if (!(error <= reached.off)) {
      reached.joint = joints_[i]->name();
      reached.off = error;
    }
  }
  if (!away.empty()) {
    reached.message = config_.name + ": the trajectory is over, but " + away +
                      " from its goal; no goal tolerance is configured for it";
  }
  return reached;
}

}  // namespace cia402::bus
