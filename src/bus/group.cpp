// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/group.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/text.h"

namespace cia402::bus {
namespace {

using motion::TrajectoryErrorCode;

// How long a trajectory that ends in motion goes on, for the next may be late a little.
constexpr double kCoast = 0.02;  // s
constexpr double kCoastCycles = 3.0;

// What is asked for "now" is asked for a moment that has just passed when it comes here.
constexpr Duration kRecent = std::chrono::milliseconds(100);

}  // namespace

Group::Group(config::GroupConfig config, std::vector<Joint*> joints, Duration cycle)
    : config_(std::move(config)),
      joints_(std::move(joints)),
      cycle_(cycle),
      clock_(cycle),
      replaced_{TrajectoryErrorCode::successful,
                config_.name + ": replaced by a newer trajectory",
                TrajectoryEnd::replaced,
                {}} {
  for (const Joint* joint : joints_) descriptions_.push_back(joint->description());
}

void Group::adopt(config::GroupConfig& next) {
  std::swap(config_.tolerances, next.tolerances);
  std::swap(config_.goal_time, next.goal_time);
  std::swap(config_.stopped_velocity_tolerance, next.stopped_velocity_tolerance);
  std::swap(config_.stop_trajectory_duration, next.stop_trajectory_duration);
  std::swap(config_.allow_partial_joints_goal, next.allow_partial_joints_goal);
  std::swap(config_.stop_group_on_fault, next.stop_group_on_fault);
  for (TrajectoryRun& run : runs_) run.adopt();
}

void Group::adoptLimits() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    descriptions_[i].limits = joints_[i]->description().limits;
  }
}

bool Group::executing() const {
  return std::any_of(runs_.begin(), runs_.end(),
                     [](const TrajectoryRun& run) { return run.waiting() || run.following(); });
}

bool Group::stopping() const {
  return std::any_of(runs_.begin(), runs_.end(),
                     [](const TrajectoryRun& run) { return run.stopping(); });
}

std::string Group::refusal(const std::vector<Joint*>& joints) const {
  std::string all;
  for (const Joint* joint : joints) {
    const std::string reason = joint->refusal(config_.name);
    if (!reason.empty()) append(all, reason);
  }
  return all;
}

std::string Group::tornApart(const std::vector<Joint*>& joints) const {
  for (const Joint* joint : joints) {
    if (joint->coupling() == nullptr) continue;
    for (const Joint* other : joints_) {
      const bool named = std::find(joints.begin(), joints.end(), other) != joints.end();
      if (named || other->coupling() != joint->coupling()) continue;
      return joint->who() + " is named without " + other->name() +
             ", which the same axes move: name both";
    }
  }
  return {};
}

motion::MotionState Group::commandedAt(const Joint& joint, Time time) const {
  // In the time of the clock, also where that lags: what comes next is given out by the same clock.
  for (const TrajectoryRun& run : runs_) {
    if (const auto planned = run.planned(joint, time)) return *planned;
  }
  const auto sent = joint.sent().expected(time - clock_.time());
  return {sent.position, sent.velocity, 0.0};
}

Result<motion::MotionState> Group::stateAt(const Joint& joint, Time then, Time now) const {
  const Time time = clock_.at(then, now);
  const TrajectoryRun* leading = nullptr;
  for (const TrajectoryRun& run : runs_) {  // what was accepted later takes over
    if (run.leads(joint) && (leading == nullptr || run.startTime() <= time)) leading = &run;
  }
  if (leading != nullptr && time >= leading->startTime()) return leading->state(joint, time);
  const std::string ago = motion::formatNumber(toSeconds(now - then)) + " s ago";
  if (leading != nullptr && leading->startTime() <= clock_.time()) {
    const std::string running =
        motion::formatNumber(toSeconds(clock_.time() - leading->startTime()));
    return Error{joint.who() + " follows a trajectory that began " + running +
                 " s ago; what was before it, " + ago + ", is not known any more"};
  }
  const std::string refusal = joint.refusal(config_.name);
  if (!refusal.empty()) return Error{refusal};
  const drive::SetPoint& sent = joint.sent();
  if (then < now && !(sent.atRest() && then >= sent.movedAt()) && now - then > kRecent) {
    return Error{joint.who() + ": where it was commanded to be " + ago + " is not known any more"};
  }
  const auto planned = sent.expected(std::max(then - now, Duration::zero()));
  const double since = std::min(0.0, toSeconds(then - now));
  return motion::MotionState{planned.position + since * planned.velocity, planned.velocity, 0.0};
}

motion::TrajectoryRules Group::rulesOf(const TrajectoryCommand& command) const {
  motion::TrajectoryRules rules;
  rules.strict = config_.strict;
  rules.margin = config_.acceleration_margin;
  rules.longer_share = config_.lengthening;
  rules.longer_s = command.tolerances.goal_time.value_or(config_.goal_time);
  rules.streamed = command.streamed;
  rules.coast_s = std::max(kCoastCycles * toSeconds(cycle_), kCoast);
  return rules;
}

TrajectoryOutcome Group::refuse(TrajectoryErrorCode code, const std::string& why) const {
  return {code, config_.name + ": trajectory refused: " + why, TrajectoryEnd::refused, {}};
}

TrajectoryOutcome Group::start(const TrajectoryCommand& command, Time now) {
  std::vector<Joint*> joints;
  std::vector<motion::Joint> descriptions;
  std::vector<std::size_t> places;
  const bool stops = command.points.empty();
  if (stops && command.joints.empty()) return startStop(command, joints_, now);
  const auto found =
      motion::matchJoints(descriptions_, command.joints, config_.allow_partial_joints_goal);
  if (!found) return refuse(TrajectoryErrorCode::invalid_joints, found.error().message);
  for (const motion::JointPlace& named : *found) {
    joints.push_back(joints_[named.joint]);
    descriptions.push_back(descriptions_[named.joint]);
    places.push_back(named.place);
  }
  const std::string torn = tornApart(joints);
  if (!torn.empty()) return refuse(TrajectoryErrorCode::invalid_joints, torn);
  if (stops) return startStop(command, joints, now);
  const std::string why_not = refusal(joints);
  if (!why_not.empty()) return refuse(TrajectoryErrorCode::invalid_goal, why_not);
  if (runs_.empty()) {
    clock_.set(now);
    starts_ = true;
  }
  beginDue(now);  // what came since the last cycle is followed until this one begins
  motion::TrajectoryStart start;
  start.now = clock_.time();
  if (command.start_time) start.start_time = clock_.at(*command.start_time, now);
  start.shortest_way = true;
  std::vector<motion::MotionState> from;
  for (const Joint* joint : joints) from.push_back(commandedAt(*joint, start.begin()));
  auto trajectory = motion::Trajectory::create(descriptions, from, reorder(command.points, places),
                                               start, rulesOf(command));
  if (!trajectory) return refuse(trajectory.error().code, trajectory.error().message);
  TrajectoryOutcome accepted{TrajectoryErrorCode::successful,
                             config_.name + ": trajectory accepted"};
  accepted.passed_points = command.start_time ? trajectory->droppedPoints() : 0;
  if (accepted.passed_points > 0) {
    accepted.message += " without the first " + std::to_string(accepted.passed_points) + " of " +
                        std::to_string(command.points.size()) +
                        " points, whose time has passed: it was to begin " +
                        motion::formatNumber(toSeconds(now - *command.start_time)) + " s ago";
  }
  if (trajectory->delay() > 0.0) {
    accepted.slowed = !command.streamed || command.points.size() > 1;  // a stream is not told of
    append(accepted.message, slowedText(*trajectory));
  }
  add({config_, TrajectoryOrder{command.id, command.ended, command.tolerances}, joints,
       std::move(trajectory).value()},
      now);
  for (Joint* joint : joints) joint->follow(&config_.name);
  return accepted;
}

/// What waits behind others begins in the cycle in which its time has come.
void Group::add(TrajectoryRun run, Time now) {
  for (TrajectoryRun& other : runs_) {
    if (other.waiting()) other.leave(run, replaced_);
  }
  const bool free = std::none_of(runs_.begin(), runs_.end(), [&](const TrajectoryRun& other) {
    return !other.ended() && other.meets(run);
  });
  if (free) run.begin(now);
  runs_.push_back(std::move(run));
  sweep();
}

void Group::beginDue(Time now) {
  for (TrajectoryRun& run : runs_) {
    if (!run.waiting() || clock_.time() < run.startTime()) continue;
    for (TrajectoryRun& other : runs_) {
      if (&other != &run && !other.waiting()) other.leave(run, replaced_);
    }
    run.begin(now);
  }
}

TrajectoryOutcome Group::startStop(const TrajectoryCommand& command,
                                   const std::vector<Joint*>& joints, Time now) {
  const TrajectoryOutcome why{TrajectoryErrorCode::successful,
                              config_.name + ": stopped by an empty trajectory",
                              TrajectoryEnd::stopped,
                              {}};
  std::vector<Joint*> ours;
  for (Joint* joint : joints) {
    if (!joint->followsAnother(config_.name)) ours.push_back(joint);
  }
  beginDue(now);  // what came since the last cycle takes over first, and is stopped then
  for (TrajectoryRun& run : runs_) {
    if (run.within(joints)) stop(run, why);
  }
  for (Joint* joint : ours) {
    const bool stops = std::any_of(runs_.begin(), runs_.end(), [&](const TrajectoryRun& run) {
      return run.stopping() && run.has(*joint);
    });
    if (!joint->ready()) continue;
    if (!stops) joint->stop(fromSeconds(config_.stop_trajectory_duration));
    joint->follow(&config_.name);
  }
  for (TrajectoryRun& run : runs_) {
    if (!run.following() && !run.waiting()) continue;
    for (const Joint* joint : ours) run.leave(*joint, replaced_);
  }
  // Of those that something else moves it is awaited, too, that they stand.
  runs_.emplace_back(config_, TrajectoryOrder{command.id, command.ended, command.tolerances},
                     joints, std::nullopt);
  runs_.back().expectRest(
      {TrajectoryErrorCode::successful, config_.name + ": stands", TrajectoryEnd::stopped, {}});
  sweep();
  return {TrajectoryErrorCode::successful, config_.name + ": stopping"};
}

void Group::stop(TrajectoryRun& run, const TrajectoryOutcome& why) {
  if (run.waiting()) return run.end(why);
  if (run.stopping() && why.code != TrajectoryErrorCode::successful) run.hasten();
  if (!run.following()) return;
  run.stop(why);
  for (TrajectoryRun& other : runs_) {  // planned from where this one would have led
    if (other.waiting() && other.meets(run)) other.end(why);
  }
}

void Group::cancel(std::uint64_t id, Time now) {
  if (id == 0) return;
  beginDue(now);
  for (TrajectoryRun& run : runs_) {
    if (run.id() != id) continue;
    stop(run, {TrajectoryErrorCode::successful,
               config_.name + ": cancelled",
               TrajectoryEnd::stopped,
               {}});
  }
  sweep();
}

void Group::stop(const TrajectoryOutcome& why) {
  TrajectoryOutcome outcome = why;
  outcome.end = TrajectoryEnd::stopped;
  for (TrajectoryRun& run : runs_) stop(run, outcome);
  sweep();
}

void Group::sweep() {
  for (Joint* joint : joints_) {
    bool left = false;
    bool taken = false;
    for (const TrajectoryRun& run : runs_) {
      if (run.has(*joint)) (run.ended() ? left : taken) = true;
    }
    if (left && !taken && !joint->followsAnother(config_.name)) joint->follow(nullptr);
  }
  runs_.erase(std::remove_if(runs_.begin(), runs_.end(),
                             [](const TrajectoryRun& run) { return run.ended(); }),
              runs_.end());
}

void Group::advanceClock(Time now) {
  bool moves = false;
  Time next = kNever;
  for (const TrajectoryRun& run : runs_) {
    if (run.stopping()) continue;
    const bool begun = run.following() && clock_.time() >= run.startTime();
    moves = moves || begun;
    if (!begun) next = std::min(next, run.startTime());
  }
  if (!moves) {
    clock_.idle(now, next);
  } else if (std::exchange(starts_, false)) {
    clock_.begin(now);
  } else {
    clock_.cycle(now, joints_.front()->late());
    clock_.advance(clock_.rate() == 1.0 ? 1.0 : permittedRise());
  }
}

double Group::permittedRise() const {
  double rise = 1e9;
  for (const TrajectoryRun& run : runs_) {
    if (run.following()) rise = std::min(rise, run.permittedRise(clock_));
  }
  return rise;
}

const std::vector<TrajectoryOutcome>& Group::step(Time now) {
  ended_.clear();
  if (runs_.empty()) return ended_;
  for (TrajectoryRun& run : runs_) run.noteDropped();
  advanceClock(now);
  beginDue(now);
  stopFailed();
  bool any_ended = false;
  for (TrajectoryRun& run : runs_) {
    if (!run.ended()) stepRun(run, now);
    any_ended = any_ended || run.ended();
  }
  if (any_ended) sweep();
  return ended_;
}

void Group::stopFailed() {
  std::optional<TrajectoryOutcome> failure;
  for (const TrajectoryRun& run : runs_) {
    if (!failure && run.following()) failure = run.failure(clock_.time());
  }
  if (!failure) return;
  for (TrajectoryRun& run : runs_) {
    stop(run, *failure);
    if (run.stopping()) run.hasten();
  }
  // A stop that was called is told when the joints stand.
  if (failure->end == TrajectoryEnd::failed) ended_.push_back(std::move(*failure));
}

void Group::stepRun(TrajectoryRun& run, Time now) {
  std::optional<TrajectoryOutcome> ended;
  if (run.following()) {
    const bool at_goal = run.atGoal(clock_.time());
    run.follow(clock_.time());
    if (at_goal) ended = run.arrival(clock_.time());
  } else if (run.stopping()) {
    ended = run.standstill(now);
  }
  if (!ended) return;
  // A failure was told as the stop began, and who only waits for rest has stopped nothing.
  const bool told = run.stopping() && ended->end == TrajectoryEnd::failed;
  run.end(*ended);
  if (!told && run.hasTrajectory()) ended_.push_back(std::move(*ended));
}

std::vector<motion::MotionState> Group::commanded() const {
  std::vector<motion::MotionState> states;
  const double rate = clock_.rate();
  for (const Joint* joint : joints_) {
    motion::MotionState state{joint->sent().value(), joint->sent().velocity(), 0.0};
    for (const TrajectoryRun& run : runs_) {
      const auto planned = run.planned(*joint, clock_.time());
      if (planned) {
        state = {planned->position, planned->velocity * rate, planned->acceleration * rate * rate};
      }
    }
    states.push_back(state);
  }
  return states;
}

}  // namespace cia402::bus
