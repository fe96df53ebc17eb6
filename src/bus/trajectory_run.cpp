// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/trajectory_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/text.h"

namespace cia402::bus {
namespace {

using motion::TrajectoryErrorCode;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr Duration kSettles = std::chrono::milliseconds(400);  // at least, after a stop
constexpr double kArrived = 0.01;  // rad or m; "reached" where no goal tolerance is configured

/// "0.1 rad".
std::string distance(const Joint& joint, double way) {
  return motion::lengthText(way, joint.description().unit);
}

/// "0.1 rad/s".
std::string speed(const Joint& joint, double velocity) { return distance(joint, velocity) + "/s"; }

}  // namespace

std::string slowedText(const motion::Trajectory& trajectory) {
  return "slowed down, it ends " + motion::formatNumber(trajectory.delay()) +
         " s later than asked, for " + trajectory.excess();
}

TrajectoryRun::TrajectoryRun(const config::GroupConfig& group, TrajectoryOrder order,
                             const std::vector<Joint*>& joints,
                             std::optional<motion::Trajectory> trajectory)
    : group_(&group),
      order_(std::move(order)),
      trajectory_(std::move(trajectory)),
      positions_(joints.size()),
      phase_(trajectory_ ? Phase::waiting : Phase::stopping) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Joint* const joint = joints[i];
    members_.push_back({joint, i, toleranceOf(joint->name()), joint->sent().breaks(),
                        joint->noticeCount(), joint->sent().givenUp(), !joint->ready(),
                        drive::Standstill(group.stopped_velocity_tolerance, joint->resolution())});
  }
}

config::JointTolerance TrajectoryRun::toleranceOf(const std::string& joint) const {
  config::JointTolerance tolerance;
  const auto of_group = group_->tolerances.find(joint);
  if (of_group != group_->tolerances.end()) tolerance = of_group->second;
  const auto own = order_.tolerances.joints.find(joint);
  if (own == order_.tolerances.joints.end()) return tolerance;
  return {own->second.trajectory.value_or(tolerance.trajectory),
          own->second.goal.value_or(tolerance.goal)};
}

/// Whether a motor stands is watched anew where that means something else.
void TrajectoryRun::adopt() {
  for (Member& member : members_) {
    member.tolerance = toleranceOf(member.joint->name());
    const drive::Standstill rest(group_->stopped_velocity_tolerance, member.joint->resolution());
    if (member.rest.tolerance() != rest.tolerance()) member.rest = rest;
  }
}

bool TrajectoryRun::has(const Joint& joint) const {
  return std::any_of(members_.begin(), members_.end(),
                     [&](const Member& member) { return member.joint == &joint; });
}

bool TrajectoryRun::meets(const TrajectoryRun& other) const {
  return std::any_of(members_.begin(), members_.end(),
                     [&](const Member& member) { return other.has(*member.joint); });
}

bool TrajectoryRun::within(const std::vector<Joint*>& joints) const {
  return std::all_of(members_.begin(), members_.end(), [&](const Member& member) {
    return std::find(joints.begin(), joints.end(), member.joint) != joints.end();
  });
}

const TrajectoryRun::Member* TrajectoryRun::memberOf(const Joint& joint) const {
  for (const Member& member : members_) {
    if (member.joint == &joint && !member.dropped) return &member;
  }
  return nullptr;
}

bool TrajectoryRun::leads(const Joint& joint) const {
  return (following() || waiting()) && memberOf(joint) != nullptr;
}

motion::MotionState TrajectoryRun::state(const Joint& joint, Time time) const {
  return trajectory_->sample(memberOf(joint)->place, time);
}

std::optional<motion::MotionState> TrajectoryRun::planned(const Joint& joint, Time time) const {
  if (phase_ != Phase::following || memberOf(joint) == nullptr) return std::nullopt;
  return state(joint, time);
}

/// The joints' own accelerations come with the square of the rate, so that both together keep the
/// limit: rise * velocity + rate² * acceleration.
double TrajectoryRun::permittedRise(const MotionClock& clock) const {
  constexpr double kLeast = 0.1;  // of the limit, where the trajectory takes all of it
  const double rate = clock.rate();
  double rise = 1e9;
  for (const Member& member : members_) {
    const motion::MotionState state = trajectory_->sample(member.place, clock.time());
    const double limit = member.joint->stopDeceleration();
    const double left = limit - rate * rate * std::abs(state.acceleration);
    const double speed = std::max(std::abs(state.velocity), 1e-9);
    rise = std::min(rise, std::max(left, kLeast * limit) / speed);
  }
  return rise;
}

void TrajectoryRun::begin(Time now) {
  began_ = now;
  phase_ = Phase::following;
  for (const Member& member : members_) positions_[member.place] = member.joint->sent().value();
}

void TrajectoryRun::leave(const Joint& joint, const TrajectoryOutcome& replaced) {
  const auto gone = std::remove_if(members_.begin(), members_.end(),
                                   [&](const Member& member) { return member.joint == &joint; });
  if (gone == members_.end()) return;
  members_.erase(gone, members_.end());
  const bool any_left = std::any_of(members_.begin(), members_.end(),
                                    [](const Member& member) { return !member.dropped; });
  if (!any_left) phase_ = Phase::ended;
  order_.tell(replaced);
}

void TrajectoryRun::leave(const TrajectoryRun& other, const TrajectoryOutcome& replaced) {
  for (const Member& member : other.members_) leave(*member.joint, replaced);
}

void TrajectoryRun::stop(const TrajectoryOutcome& why) {
  outcome_ = why;
  if (why.end == TrajectoryEnd::failed) order_.tell(why);
  const bool failed = why.code != TrajectoryErrorCode::successful;
  const Duration over = failed ? Duration::zero() : fromSeconds(group_->stop_trajectory_duration);
  for (Member& member : members_) {
    if (!member.dropped) member.joint->stop(over);
    member.breaks = member.joint->sent().breaks();
  }
  phase_ = Phase::stopping;
}

void TrajectoryRun::hasten() {
  for (Member& member : members_) {
    if (!member.dropped) member.joint->stop();
  }
}

void TrajectoryRun::end(const TrajectoryOutcome& outcome) {
  phase_ = Phase::ended;
  order_.tell(outcome);
}

void TrajectoryRun::noteDropped() {
  for (Member& member : members_) {
    if (member.dropped || member.joint->goesOn(member.breaks)) continue;
    member.dropped = true;
    member.stopped_by = member.joint->stoppedBy();
  }
}

std::optional<TrajectoryOutcome> TrajectoryRun::failure(Time time) const {
  if (refused_ != nullptr) {  // which ends the axis' set-points, too
    return TrajectoryOutcome{TrajectoryErrorCode::path_tolerance_violated,
                             group_->name + ": trajectory stopped: " + refused_->who() +
                                 " refused a set-point: it does not fit the drive or is beyond the "
                                 "joint's limits",
                             TrajectoryEnd::failed, refused_->name()};
  }
  if (auto failed = axisFailure()) return failed;
  return pathFailure(time);
}

std::optional<TrajectoryOutcome> TrajectoryRun::axisFailure() const {
  const auto dropped = [](const Member& member) { return member.dropped; };
  const auto first = std::find_if(members_.begin(), members_.end(), dropped);
  if (first == members_.end()) return std::nullopt;
  std::string left;
  if (!group_->stop_group_on_fault) {
    if (!std::all_of(members_.begin(), members_.end(), dropped)) return std::nullopt;
    left = "no joint is left to follow it: ";
  }
  const auto failed = std::find_if(members_.begin(), members_.end(), [](const Member& member) {
    return member.dropped && member.stopped_by == drive::ProcedureKind::none;
  });
  if (failed == members_.end()) return calledStop(*first);
  return blame(TrajectoryErrorCode::path_tolerance_violated, *failed, kNothing,
               ": trajectory stopped: " + left + failed->joint->trouble(failed->notices));
}

TrajectoryOutcome TrajectoryRun::calledStop(const Member& member) const {
  return {TrajectoryErrorCode::successful,
          group_->name + ": stopped: " + member.joint->who() + ": " +
              drive::toString(member.stopped_by) + " was called",
          TrajectoryEnd::stopped,
          {}};
}

std::optional<TrajectoryOutcome> TrajectoryRun::pathFailure(Time time) const {
  for (const Member& member : members_) {
    const double tolerance = member.tolerance.trajectory;
    if (tolerance <= 0.0 || member.dropped) continue;
    const Joint& joint = *member.joint;
    const double error = std::abs(positions_[member.place] - joint.position());
    if (began_ < joint.stamp() && error > tolerance) {
      return blame(TrajectoryErrorCode::path_tolerance_violated, member, error,
                   ": trajectory stopped: " + joint.who() + " is " + distance(joint, error) +
                       " off its path at " +
                       motion::formatNumber(toSeconds(time - trajectory_->startTime())) +
                       " s, the tolerance is " + distance(joint, tolerance));
    }
  }
  return std::nullopt;
}

bool TrajectoryRun::atGoal(Time time) const {
  if (!trajectory_->finished(time)) return false;
  return std::all_of(members_.begin(), members_.end(), [&](const Member& member) {
    if (member.dropped) return true;
    // A goal that lies beyond a limit by rounding is sent as that limit.
    const double sent = member.joint->sent().value(), goal = trajectory_->goal()[member.place];
    return motion::withinReach(member.joint->description().limits, goal, sent) == sent;
  });
}

void TrajectoryRun::follow(Time time) {
  trajectory_->samplePositions(time, positions_);
  for (const Member& member : members_) {
    // An axis that fell out of operation holds or stops by itself; the others go on as configured.
    // Enabled again, it must not jump to where the trajectory is by now.
    if (!member.dropped && !member.joint->give(positions_[member.place])) refused_ = member.joint;
  }
}

std::optional<TrajectoryOutcome> TrajectoryRun::standstill(Time now) {
  const Member* restless = nullptr;
  bool rest_commanded = true;
  for (Member& member : members_) {
    // Something else stops one that was dropped: of that nothing but its motor tells.
    if (member.dropped && !member.joint->known()) {
      rest_commanded = rest_commanded && !member.joint->partIsLed();
      const bool moves = !hasTrajectory() || member.joint->partMoves();  // for all that is known
      if (restless == nullptr && moves) restless = &member;
      continue;
    }
    // One that was held apart from its set-points may move again as they are called back to it.
    const std::uint32_t given_up = member.joint->sent().givenUp();
    const bool called_back = std::exchange(member.given_up, given_up) != given_up;
    const Joint& joint = *member.joint;
    const bool others = occupied(member);
    const bool led = !member.dropped && joint.handsOver();
    if (called_back || led) member.rest.reset();  // how it moves by that is not to be seen yet
    member.rest.update(joint.position(), joint.stamp());
    const bool commanded = member.dropped ? !joint.beingStopped() : joint.sent().atRest();
    rest_commanded = rest_commanded && (others || (commanded && !led && !joint.endsGoal()));
    if (others || (restless == nullptr && !rests(member))) restless = &member;
  }
  if (!rest_commanded) commanded_rest_.reset();
  if (!rest_commanded) return std::nullopt;
  if (restless == nullptr) return outcome_;
  if (!commanded_rest_) commanded_rest_ = now;
  if (now < *commanded_rest_ + std::max(fromSeconds(goalTime()), kSettles)) {
    return std::nullopt;
  }
  if (occupied(*restless)) return notStopped(*restless);
  if (!hasTrajectory() && !restless->joint->known()) return notKnown(*restless);
  TrajectoryOutcome outcome = outcome_;
  outcome.message += ", but " + stillMoves(*restless) + ", " + restAsked(*restless);
  return outcome;
}

bool TrajectoryRun::occupied(const Member& member) const {
  return !hasTrajectory() && member.joint->occupied(group_->name);
}

TrajectoryOutcome TrajectoryRun::notStopped(const Member& member) const {
  return blame(
      TrajectoryErrorCode::goal_tolerance_violated, member, kNothing,
      ": " + member.joint->who() + " is not stopped by this: " + member.joint->occupation());
}

TrajectoryOutcome TrajectoryRun::notKnown(const Member& member) const {
  return blame(TrajectoryErrorCode::goal_tolerance_violated, member, kNothing,
               ": whether " + member.joint->name() +
                   " stands is not known: " + member.joint->trouble(member.notices));
}

TrajectoryOutcome TrajectoryRun::blame(TrajectoryErrorCode code, const Member& member, double off,
                                       const std::string& text) const {
  return {code, group_->name + text, TrajectoryEnd::failed, member.joint->name(), off};
}

bool TrajectoryRun::rests(const Member& member) const {
  return group_->stopped_velocity_tolerance <= 0.0 || member.rest.still();
}

TrajectoryOutcome TrajectoryRun::restlessness(const Member& member) const {
  return blame(TrajectoryErrorCode::goal_tolerance_violated, member, kNothing,
               ": goal missed: " + stillMoves(member) + " " + motion::formatNumber(goalTime()) +
                   " s after the end, " + restAsked(member) +
                   ", or give a larger goal_time or tolerance");
}

std::string TrajectoryRun::stillMoves(const Member& member) const {
  const double velocity = std::abs(member.rest.velocity());
  return member.joint->who() + " still moves" +
         (std::isfinite(velocity) ? " at " + speed(*member.joint, velocity) : std::string());
}

std::string TrajectoryRun::restAsked(const Member& member) const {
  return "its stopped_velocity_tolerance is " +
         speed(*member.joint, group_->stopped_velocity_tolerance) +
         "; see whether it swings or is pushed";
}

std::optional<TrajectoryOutcome> TrajectoryRun::arrival(Time time) {
  const Member* stopped = nullptr;
  for (Member& member : members_) {
    member.rest.update(member.joint->position(), member.joint->stamp());
    if (!member.dropped) continue;
    stopped = &member;
    if (member.stopped_by != drive::ProcedureKind::none) continue;
    return blame(TrajectoryErrorCode::goal_tolerance_violated, member, kNothing,
                 ": goal missed: " + member.joint->trouble(member.notices));
  }
  if (stopped != nullptr) {  // the others are at their goals: nothing is to be stopped any more
    outcome_ = calledStop(*stopped);
    phase_ = Phase::stopping;
    return std::nullopt;
  }
  const bool late = time >= trajectory_->endTime() + fromSeconds(goalTime());
  std::string away;  // without a tolerance that is no failure, but it is told
  TrajectoryOutcome reached{TrajectoryErrorCode::successful, group_->name + ": goal reached"};
  for (const Member& member : members_) {
    const Joint& joint = *member.joint;
    const double tolerance = member.tolerance.goal;
    const bool judged = tolerance > 0.0;
    const double error = std::abs(trajectory_->goal()[member.place] - joint.position());
    const bool arrived = error <= (judged ? tolerance : kArrived);
    if (arrived && rests(member) && (late || !joint.handsOver())) continue;
    if (!late) return std::nullopt;
    if (arrived) return restlessness(member);
    const std::string where = joint.who() + " is " + distance(joint, error) + " away";
    if (judged) {
      return blame(TrajectoryErrorCode::goal_tolerance_violated, member, error,
                   ": goal missed: " + where + " " + motion::formatNumber(goalTime()) +
                       " s after the end, the tolerance is " + distance(joint, tolerance));
    }
    append(away, where, ", ");
    if (!(error <= reached.off)) {
      reached.joint = joint.name();
      reached.off = error;
    }
  }
  if (trajectory_->endsInMotion()) append(reached.message, "brought to rest behind its last point");
  if (trajectory_->delay() > 0.0) append(reached.message, slowedText(*trajectory_));
  if (!away.empty()) {
    reached.message = group_->name + ": the trajectory is over, but " + away +
                      " from its goal; no goal tolerance is configured for it";
  }
  return reached;
}

}  // namespace cia402::bus
