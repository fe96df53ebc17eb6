// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/group.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cia402::bus {
namespace {

using motion::TrajectoryErrorCode;

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

std::string switchAdvice(const drive::AxisConfig& axis) {
  const drive::ModeSpec* mode = drive::trajectoryMode(axis);
  return mode == nullptr ? "no mode that it can be in does"
                         : "~" + axis.name + "/set_mode " + mode->name + " first";
}

}  // namespace

Group::Group(config::GroupConfig config, std::vector<std::size_t> axes,
             const std::vector<drive::Axis>& all)
    : config_(std::move(config)),
      axes_(std::move(axes)),
      clock_(all.empty() ? Duration(1) : all.front().config().sync_period),
      commanded_(axes_.size()),
      dropped_(axes_.size(), 0),
      next_dropped_(axes_.size(), 0),
      breaks_(axes_.size(), 0),
      notices_(axes_.size(), 0) {
  for (std::size_t axis : axes_) {
    joints_.push_back(jointOf(all[axis].config()));
    names_.push_back(drive::jointName(all[axis].config()));
    accelerations_.push_back(drive::stopDeceleration(all[axis].config()));
    const auto tolerance = config_.tolerances.find(joints_.back().name);
    tolerances_.push_back(tolerance == config_.tolerances.end() ? config::JointTolerance()
                                                                : tolerance->second);
  }
}

std::string Group::refusal(const std::vector<drive::Axis>& axes,
                           const std::vector<AxisMotion>& motions) const {
  std::string all;
  for (std::size_t axis : axes_) {
    std::string reason = axes[axis].motionRefusal();
    const drive::ModeSpec* mode = axes[axis].state().mode;
    if (reason.empty() &&
        (mode == nullptr || !mode->cyclic || mode->kind != drive::ControlKind::position)) {
      reason = drive::jointName(axes[axis].config()) + " is in mode " +
               (mode ? mode->name : "unknown") +
               ", which does not follow trajectories: " + switchAdvice(axes[axis].config());
    }
    const std::string* owner = motions[axis].owner();
    if (reason.empty() && owner != nullptr && owner != &config_.name) {
      reason = drive::jointName(axes[axis].config()) + " follows a trajectory of group " + *owner;
    }
    // In the cycle in which a trajectory has ended, the motion still knows the way to its goal
    // only.
    const bool rests = motions[axis].atRest() || axes[axis].setPoint().atRest();
    if (reason.empty() && owner == nullptr && !rests) {
      reason = drive::jointName(axes[axis].config()) +
               " is still moved by streamed set-points: end the stream and let it come to rest";
    }
    if (!reason.empty()) all += (all.empty() ? "" : "; ") + reason;
  }
  return all;
}

std::vector<motion::MotionState> Group::commandedAt(const std::vector<drive::Axis>& axes,
                                                    Time time) const {
  std::vector<motion::MotionState> states(axes_.size());
  // In the time of the clock, also where that lags: what comes next is given out by the same clock.
  const bool planned = phase_ == Phase::following;
  if (planned) trajectory_->sample(time, states);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (planned && dropped_[i] == 0) continue;
    const auto sent = axes[axes_[i]].setPoint().expected(time - clock_.time());
    states[i] = {sent.position, sent.velocity, 0.0};
  }
  return states;
}

TrajectoryOutcome Group::start(const std::vector<std::string>& names,
                               const std::vector<motion::TrajectoryPoint>& points,
                               std::optional<Time> start_time, std::vector<drive::Axis>& axes,
                               std::vector<AxisMotion>& motions, Time now) {
  if (points.empty()) {
    stop({TrajectoryErrorCode::successful, config_.name + ": stopped by an empty trajectory"},
         axes);
    return {TrajectoryErrorCode::successful, config_.name + ": stopping"};
  }
  const auto order = motion::matchJoints(joints_, names);
  if (!order) return {TrajectoryErrorCode::invalid_joints, order.error().message};
  const std::string why_not = refusal(axes, motions);
  if (!why_not.empty()) {
    return {TrajectoryErrorCode::invalid_goal, config_.name + ": trajectory refused: " + why_not};
  }
  if (phase_ == Phase::idle) {
    clock_.set(now);
    starts_ = true;
  }
  motion::TrajectoryStart start;
  start.now = clock_.time();
  if (start_time) start.start_time = clock_.at(*start_time, now);
  start.shortest_way = true;
  auto trajectory = motion::Trajectory::create(joints_, commandedAt(axes, start.begin()),
                                               reorder(points, *order), start);
  if (!trajectory) return {trajectory.error().code, trajectory.error().message};
  next_ = std::move(trajectory).value();
  std::fill(next_dropped_.begin(), next_dropped_.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    breaks_[i] = axes[axes_[i]].setPoint().breaks();
    notices_[i] = axes[axes_[i]].noticeCount();
  }
  if (phase_ == Phase::idle) {
    showSent(axes);
    beginNext(now);
  }
  for (std::size_t axis : axes_) motions[axis].setOwner(&config_.name);
  return {TrajectoryErrorCode::successful, config_.name + ": trajectory accepted"};
}

void Group::beginNext(Time now) {
  began_ = now;
  trajectory_ = std::move(next_);
  next_.reset();
  phase_ = Phase::following;
  refused_ = nullptr;
  dropped_ = next_dropped_;
}

/// A joint that was not ready for a while, or whose set-points were ended by anything else (another
/// zero of its positions, a motor that stands), is not where its trajectories were planned from.
void Group::noteDropped(const std::vector<drive::Axis>& axes) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const drive::Axis& axis = axes[axes_[i]];
    if (!axis.state().ready_for_motion || axis.setPoint().breaks() != breaks_[i]) {
      dropped_[i] = next_dropped_[i] = 1;
    }
  }
}

void Group::stop(const TrajectoryOutcome& why, std::vector<drive::Axis>& axes) {
  if (!executing()) return;
  outcome_ = why;
  if (phase_ == Phase::following) beginStop(axes);
  next_.reset();
}

void Group::beginStop(std::vector<drive::Axis>& axes) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    drive::Axis& axis = axes[axes_[i]];
    if (dropped_[i] == 0) axis.stopSetPoint();
    breaks_[i] = axis.setPoint().breaks();
  }
  trajectory_.reset();
  next_.reset();
  phase_ = Phase::stopping;
}

/// The joints' own accelerations come with the square of the rate, so that both together keep the
/// limit: rise * velocity + rate² * acceleration.
double Group::permittedRise() const {
  constexpr double kLeast = 0.1;  // of the limit, where the trajectory takes all of it
  const double rate = clock_.rate();
  double rise = 1e9;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const motion::MotionState state = trajectory_->sample(i, clock_.time());
    const double limit = accelerations_[i];
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
    clock_.cycle(now);
    clock_.advance(clock_.rate() == 1.0 ? 1.0 : permittedRise());
  }
}

void Group::follow(std::vector<drive::Axis>& axes) {
  trajectory_->sample(clock_.time(), commanded_);
  if (clock_.rate() < 1.0) scaleCommanded();
  sendSetpoints(axes);
}

void Group::scaleCommanded() {
  for (motion::MotionState& state : commanded_) {
    state.velocity *= clock_.rate();
    state.acceleration *= clock_.rate() * clock_.rate();
  }
}

void Group::showSent(const std::vector<drive::Axis>& axes) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const drive::SetPoint& sent = axes[axes_[i]].setPoint();
    commanded_[i] = {sent.value(), sent.velocity(), 0.0};
  }
}

bool Group::stands(const std::vector<drive::Axis>& axes) const {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (dropped_[i] == 0 && !axes[axes_[i]].setPoint().atRest()) return false;
  }
  return true;
}

/// The goal was sent already: given once more, the set-points are at rest there.
bool Group::atGoal(const std::vector<drive::Axis>& axes) const {
  if (!trajectory_->finished(clock_.time())) return false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (dropped_[i] == 0 && axes[axes_[i]].target() != trajectory_->goal()[i]) return false;
  }
  return true;
}

std::optional<TrajectoryOutcome> Group::step(std::vector<drive::Axis>& axes,
                                             std::vector<AxisMotion>& motions, Time now) {
  if (phase_ == Phase::idle) return std::nullopt;
  noteDropped(axes);
  advanceClock(now);
  if (next_ && clock_.time() >= next_->startTime()) beginNext(now);
  if (phase_ == Phase::following) {
    auto ended = checkRefusal();  // which ends the axis' set-points, too
    if (!ended) ended = checkAxes(axes);
    if (!ended) ended = checkPath(axes);
    if (ended) {
      outcome_ = *ended;
      beginStop(axes);
    }
  }
  if (phase_ == Phase::following) {
    const bool at_goal = !next_ && atGoal(axes);
    follow(axes);
    if (!at_goal) return std::nullopt;
    const auto reached = checkGoal(axes);
    if (!reached) return std::nullopt;
    outcome_ = *reached;
    release(motions);
    return outcome_;
  }
  showSent(axes);
  if (next_ || !stands(axes)) return std::nullopt;
  release(motions);
  return outcome_;
}

void Group::sendSetpoints(std::vector<drive::Axis>& axes) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    // An axis that fell out of operation holds or stops by itself; the others go on as configured.
    // Enabled again, it must not jump to where the trajectory is by now.
    if (dropped_[i] == 0 && !axes[axes_[i]].setTarget(commanded_[i].position)) {
      refused_ = &names_[i];
    }
  }
}

void Group::release(std::vector<AxisMotion>& motions) {
  for (std::size_t axis : axes_) motions[axis].setOwner(nullptr);
  trajectory_.reset();
  phase_ = Phase::idle;
}

std::optional<TrajectoryOutcome> Group::checkAxes(const std::vector<drive::Axis>& axes) const {
  bool any_ready = false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (dropped_[i] == 0) {
      any_ready = true;
    } else if (config_.stop_group_on_fault) {
      return TrajectoryOutcome{TrajectoryErrorCode::path_tolerance_violated,
                               config_.name + ": trajectory stopped: " + dropReason(axes, i)};
    }
  }
  if (any_ready) return std::nullopt;
  return TrajectoryOutcome{TrajectoryErrorCode::path_tolerance_violated,
                           config_.name + ": trajectory stopped: no joint is enabled any more"};
}

std::string Group::dropReason(const std::vector<drive::Axis>& axes, std::size_t joint) const {
  const drive::Axis& axis = axes[axes_[joint]];
  const std::string reason = axis.motionRefusal();
  if (!reason.empty()) return reason;
  if (axis.noticeCount() != notices_[joint]) return axis.notice();
  return names_[joint] + " fell out of operation or got another zero on the way";
}

std::optional<TrajectoryOutcome> Group::checkRefusal() const {
  if (refused_ == nullptr) return std::nullopt;
  return TrajectoryOutcome{TrajectoryErrorCode::path_tolerance_violated,
                           config_.name + ": trajectory stopped: " + *refused_ +
                               " refused a set-point: it does not fit the drive or is beyond the "
                               "joint's limits"};
}

std::optional<TrajectoryOutcome> Group::checkPath(const std::vector<drive::Axis>& axes) const {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const drive::AxisState& state = axes[axes_[i]].state();
    if (tolerances_[i].trajectory <= 0.0 || dropped_[i] != 0) continue;
    const double error = commanded_[i].position - state.position;
    if (began_ < state.stamp && std::abs(error) > tolerances_[i].trajectory) {
      return TrajectoryOutcome{
          TrajectoryErrorCode::path_tolerance_violated,
          config_.name + ": trajectory stopped: " + names_[i] + " is " +
              motion::formatNumber(std::abs(error)) + " " + motion::toString(joints_[i].unit) +
              " off its path, the tolerance is " + motion::formatNumber(tolerances_[i].trajectory)};
    }
  }
  return std::nullopt;
}

std::optional<TrajectoryOutcome> Group::checkGoal(const std::vector<drive::Axis>& axes) const {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (dropped_[i] == 0) continue;
    return TrajectoryOutcome{TrajectoryErrorCode::goal_tolerance_violated,
                             config_.name + ": goal missed: " + dropReason(axes, i)};
  }
  std::string away;  // without a tolerance that is no failure, but it is told
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const bool judged = tolerances_[i].goal > 0.0;
    const double error = std::abs(trajectory_->goal()[i] - axes[axes_[i]].state().position);
    if (error <= (judged ? tolerances_[i].goal : kArrived)) continue;
    if (clock_.time() < trajectory_->endTime() + fromSeconds(config_.goal_time))
      return std::nullopt;
    const std::string where = names_[i] + " is " + motion::formatNumber(error) + " " +
                              motion::toString(joints_[i].unit) + " away";
    if (judged) {
      return TrajectoryOutcome{TrajectoryErrorCode::goal_tolerance_violated,
                               config_.name + ": goal missed: " + where + " after " +
                                   motion::formatNumber(config_.goal_time) +
                                   " s, the tolerance is " +
                                   motion::formatNumber(tolerances_[i].goal)};
    }
    away += (away.empty() ? "" : ", ") + where;
  }
  if (away.empty()) {
    return TrajectoryOutcome{TrajectoryErrorCode::successful, config_.name + ": goal reached"};
  }
  return TrajectoryOutcome{TrajectoryErrorCode::successful,
                           config_.name + ": the trajectory is over, but " + away +
                               " from its goal; no goal tolerance is configured for it"};
}

}  // namespace cia402::bus
