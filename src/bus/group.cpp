// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/group.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bus/words.h"

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

Group::Group(config::GroupConfig config, std::vector<AxisUnit*> axes)
    : config_(std::move(config)),
      axes_(std::move(axes)),
      clock_(axes_.empty() ? Duration(1) : axes_.front()->axis.config().sync_period),
      commanded_(axes_.size()),
      dropped_(axes_.size(), 0),
      next_dropped_(axes_.size(), 0),
      breaks_(axes_.size(), 0),
      notices_(axes_.size(), 0) {
  for (const AxisUnit* unit : axes_) {
    const drive::AxisConfig& axis = unit->axis.config();
    joints_.push_back(jointOf(axis));
    names_.push_back(drive::jointName(axis));
    accelerations_.push_back(drive::stopDeceleration(axis));
    const auto tolerance = config_.tolerances.find(joints_.back().name);
    tolerances_.push_back(tolerance == config_.tolerances.end() ? config::JointTolerance()
                                                                : tolerance->second);
  }
}

std::string Group::refusal() const {
  std::string all;
  for (const AxisUnit* unit : axes_) {
    const std::string reason = refusalOf(*unit);
    if (!reason.empty()) append(all, reason);
  }
  return all;
}

std::string Group::refusalOf(const AxisUnit& unit) const {
  const drive::Axis& axis = unit.axis;
  std::string reason = axis.motionRefusal();
  if (!reason.empty()) return reason;
  const std::string who = drive::jointName(axis.config());
  const drive::ModeSpec* mode = axis.state().mode;
  if (mode == nullptr || !mode->cyclic || mode->kind != drive::ControlKind::position) {
    return who + " is in mode " + (mode ? mode->name : "unknown") +
           ", which does not follow trajectories: " + switchAdvice(axis.config());
  }
  const std::string* owner = unit.motion.owner();
  if (owner != nullptr && owner != &config_.name) {
    return who + " follows a trajectory of group " + *owner;
  }
  // In the cycle in which a trajectory has ended, the motion still knows the way to its goal only.
  const bool rests = unit.motion.atRest() || axis.setPoint().atRest();
  if (owner == nullptr && !rests) {
    return who + " is still moved by streamed set-points: end the stream and let it come to rest";
  }
  return {};
}

std::vector<motion::MotionState> Group::commandedAt(Time time) const {
  std::vector<motion::MotionState> states(axes_.size());
  // In the time of the clock, also where that lags: what comes next is given out by the same clock.
  const bool planned = phase_ == Phase::following;
  if (planned) trajectory_->sample(time, states);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (planned && dropped_[i] == 0) continue;
    const auto sent = axes_[i]->axis.setPoint().expected(time - clock_.time());
    states[i] = {sent.position, sent.velocity, 0.0};
  }
  return states;
}

TrajectoryOutcome Group::start(const std::vector<std::string>& names,
                               const std::vector<motion::TrajectoryPoint>& points,
                               std::optional<Time> start_time, Time now) {
  if (points.empty()) {
    stop({TrajectoryErrorCode::successful, config_.name + ": stopped by an empty trajectory"});
    return {TrajectoryErrorCode::successful, config_.name + ": stopping"};
  }
  const auto order = motion::matchJoints(joints_, names);
  if (!order) return {TrajectoryErrorCode::invalid_joints, order.error().message};
  const std::string why_not = refusal();
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
  auto trajectory = motion::Trajectory::create(joints_, commandedAt(start.begin()),
                                               reorder(points, *order), start);
  if (!trajectory) return {trajectory.error().code, trajectory.error().message};
  next_ = std::move(trajectory).value();
  std::fill(next_dropped_.begin(), next_dropped_.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    breaks_[i] = axes_[i]->axis.setPoint().breaks();
    notices_[i] = axes_[i]->axis.noticeCount();
  }
  if (phase_ == Phase::idle) {
    showSent();
    beginNext(now);
  }
  for (AxisUnit* unit : axes_) unit->motion.setOwner(&config_.name);
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
void Group::noteDropped() {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const drive::Axis& axis = axes_[i]->axis;
    if (!axis.state().ready_for_motion || axis.setPoint().breaks() != breaks_[i]) {
      dropped_[i] = next_dropped_[i] = 1;
    }
  }
}

void Group::stop(const TrajectoryOutcome& why) {
  if (!executing()) return;
  outcome_ = why;
  if (phase_ == Phase::following) beginStop();
  next_.reset();
}

void Group::beginStop() {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    drive::Axis& axis = axes_[i]->axis;
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

void Group::follow() {
  trajectory_->sample(clock_.time(), commanded_);
  if (clock_.rate() < 1.0) scaleCommanded();
  sendSetpoints();
}

void Group::scaleCommanded() {
  for (motion::MotionState& state : commanded_) {
    state.velocity *= clock_.rate();
    state.acceleration *= clock_.rate() * clock_.rate();
  }
}

void Group::showSent() {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const drive::SetPoint& sent = axes_[i]->axis.setPoint();
    commanded_[i] = {sent.value(), sent.velocity(), 0.0};
  }
}

bool Group::stands() const {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (dropped_[i] == 0 && !axes_[i]->axis.setPoint().atRest()) return false;
  }
  return true;
}

/// The goal was sent already: given once more, the set-points are at rest there.
bool Group::atGoal() const {
  if (!trajectory_->finished(clock_.time())) return false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (dropped_[i] == 0 && axes_[i]->axis.target() != trajectory_->goal()[i]) return false;
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
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    // An axis that fell out of operation holds or stops by itself; the others go on as configured.
    // Enabled again, it must not jump to where the trajectory is by now.
    if (dropped_[i] == 0 && !axes_[i]->axis.setTarget(commanded_[i].position)) {
      refused_ = &names_[i];
    }
  }
}

void Group::release() {
  for (AxisUnit* unit : axes_) unit->motion.setOwner(nullptr);
  trajectory_.reset();
  phase_ = Phase::idle;
}

std::optional<TrajectoryOutcome> Group::checkAxes() const {
  bool any_ready = false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (dropped_[i] == 0) {
      any_ready = true;
    } else if (config_.stop_group_on_fault) {
      return TrajectoryOutcome{TrajectoryErrorCode::path_tolerance_violated,
                               config_.name + ": trajectory stopped: " + dropReason(i)};
    }
  }
  if (any_ready) return std::nullopt;
  return TrajectoryOutcome{TrajectoryErrorCode::path_tolerance_violated,
                           config_.name + ": trajectory stopped: no joint is enabled any more"};
}

std::string Group::dropReason(std::size_t joint) const {
  const drive::Axis& axis = axes_[joint]->axis;
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

std::optional<TrajectoryOutcome> Group::checkPath() const {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const drive::AxisState& state = axes_[i]->axis.state();
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

std::optional<TrajectoryOutcome> Group::checkGoal() const {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (dropped_[i] == 0) continue;
    return TrajectoryOutcome{TrajectoryErrorCode::goal_tolerance_violated,
                             config_.name + ": goal missed: " + dropReason(i)};
  }
  std::string away;  // without a tolerance that is no failure, but it is told
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const bool judged = tolerances_[i].goal > 0.0;
    const double error = std::abs(trajectory_->goal()[i] - axes_[i]->axis.state().position);
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
    append(away, where, ", ");
  }
  if (away.empty()) {
    return TrajectoryOutcome{TrajectoryErrorCode::successful, config_.name + ": goal reached"};
  }
  return TrajectoryOutcome{TrajectoryErrorCode::successful,
                           config_.name + ": the trajectory is over, but " + away +
                               " from its goal; no goal tolerance is configured for it"};
}

}  // namespace cia402::bus
