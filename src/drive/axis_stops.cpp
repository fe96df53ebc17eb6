// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How the axis comes to rest, and whether it is.
#include <algorithm>
#include <cmath>
#include <limits>

#include "axis_core.h"
#include "procedure_limits.h"
#include "sentence.h"

namespace cia402::drive {
namespace {

/// As kReactionCycles, for a drive that plans its motion, whose plan is ahead of the motor.
constexpr int kPlanningCycles = 4;
/// Of the way that braking takes, at least, a stop point is to be ahead.
constexpr double kReachable = 0.98;
/// Of two places that count as one: so far from its stop point a drive may have gone beyond it.
constexpr double kOffStopPoint = 0.25;

}  // namespace

Duration AxisCore::stopTime() const { return drive::stopTime(config_, state_.velocity); }

bool AxisCore::seenStill(Time from) const {
  return standstill_.still() &&
         standstill_.stillFrom() >= from + kReactionCycles * config_.sync_period;
}

bool AxisCore::atStandstill() const {
  return seenStill(std::max(set_point_.movedAt(), moved_itself_));
}

/// The drive has not come to where it was sent.
bool AxisCore::goalAhead() const {
  return set_point_.kind() == SetPointKind::goal && !state_.target_reached &&
         std::fabs(set_point_.value() - state_.position) > standstill_.tolerance();
}

/// The drive moves the axis as it sees fit, and what looks like standstill may be where it turns
/// back.
bool AxisCore::movesItself() const {
  if (!in_operation_ || halt_bit_ || state_.halted) return false;
  return homing_start_ || (goalAhead() && mode_->spec->target_reached_bit);
}

/// Halted by a stop point that it has passed, since that reached it late, a drive goes back to it,
/// and where it turns it seems to stand. One that stands for longer than it takes to be seen to
/// move again is held there.
bool AxisCore::mayTurnBack(Time now) const {
  if (!state_.halted || halt_bit_ || set_point_.kind() != SetPointKind::goal) return false;
  const double away = std::fabs(set_point_.value() - state_.position);
  const double slow = standstill_.tolerance() / toSeconds(Standstill::kWindow);  // per second
  const Duration unseen = fromSeconds(slow / stopDeceleration(config_)) + Standstill::kWindow;
  return away > kOffStopPoint * standstill_.tolerance() && now < seen_moving_ + unseen;
}

void AxisCore::watchDrive(Time now) {
  if (!standstill_.still()) seen_moving_ = now;
  if (movesItself() || mayTurnBack(now)) moved_itself_ = now;
}

bool AxisCore::moving() const {
  return standstill_.moving() || (in_operation_ && !set_point_.atRest());
}

bool AxisCore::mayMove() const {
  return state_.feedback_valid ? !atStandstill() : !stood_without_power_;
}

std::optional<Duration> AxisCore::withdrawTarget() {
  const bool position = mode_->spec->kind == ControlKind::position;
  if (!in_operation_ || !position || !state_.feedback_valid) return {};
  const double away = std::fabs(set_point_.value() - state_.position);
  if (away <= standstill_.tolerance()) return {};
  const bool planned = set_point_.kind() == SetPointKind::goal;
  takeTargetBack();
  const Duration reaction = kReactionCycles * config_.sync_period;
  if (!planned) return reaction;
  // What the drive has planned may be on its way still: it turns round and comes back.
  const double speed = config_.limits.velocity.value_or(std::numeric_limits<double>::infinity());
  const double ramp = stopDeceleration(config_);
  const double fastest = std::min(speed, std::sqrt(2.0 * ramp * away));
  return reaction + fromSeconds(3.0 * fastest / ramp + away / fastest);
}

void AxisCore::takeTargetBack() {
  neutralizeTarget();
  if (mode_->spec->handshake == Handshake::new_set_point) handshake_.offer(target_raw_, true);
}

void AxisCore::beginHalt(Time now) {
  if (!in_operation_ || state_.halted) return;
  set_point_.stop();
  switch (stopBy()) {
    case StopBy::halt:
      halt_bit_ = true;
      break;
    case StopBy::quick_stop:
      setGoal(Goal::quick_stop);
      return;
    case StopBy::mode:
      if (!brakeByMode(now)) setGoal(Goal::quick_stop);
      return;
    case StopBy::set_points:
      if (set_point_.kind() == SetPointKind::goal) {
        halted_goal_ = set_point_.value();
        stop_point_after_ = Time::min();
      }
      break;
  }
  state_.halted = true;
  state_.ready_for_motion = false;
}

/// The drive plans by itself: it gets the nearest point where it can stop, from where it is by the
/// newest feedback. What it does until it has that is added, for a point that is too near would
/// make it turn back: it may still be gaining speed, what it has planned is ahead of what is
/// measured, and what is measured may be old, in a late cycle. It never goes beyond a goal at which
/// it can stop; one that came nearer than that under way makes the drive turn back.
void AxisCore::giveStopPoint(Time now) {
  if (!state_.feedback_valid) return;
  const double velocity = std::isfinite(state_.velocity) ? state_.velocity : 0.0;
  const double age = toSeconds(std::max(Duration(0), now - state_.stamp - config_.sync_period));
  const double from = state_.position + velocity * age;
  const double sign = std::copysign(
      1.0, std::fabs(velocity) > config_.standstill_velocity ? velocity : halted_goal_ - from);
  const double reaction = toSeconds(kPlanningCycles * config_.sync_period);
  const double deceleration = stopDeceleration(config_), speed = std::fabs(velocity);
  const double faster = std::max(
      speed, std::min(speed + deceleration * reaction, config_.limits.velocity.value_or(1e9)));
  const double way = faster * reaction + faster * faster / (2.0 * deceleration);
  double point = from + sign * way;
  const double slowest = std::max(
      0.0, speed - deceleration * toSeconds(kReactionCycles * config_.sync_period));  // by now
  const double needed = slowest * slowest / (2.0 * deceleration);
  const bool reachable = sign * (halted_goal_ - state_.position) >= needed;
  if (reachable && sign * (halted_goal_ - from) >= 0.0)
    point = sign * std::min(sign * point, sign * halted_goal_);
  const AxisLimits& limits = config_.limits;
  if (limits.lower) point = std::max(point, std::min(*limits.lower, from));
  if (limits.upper) point = std::min(point, std::max(*limits.upper, from));
  set_point_.give(point);
}

/// After a late cycle the drive may have got its stop point so late that it lies behind it.
void AxisCore::renewStopPoint(Time now) {
  if (state_.stamp <= stop_point_after_) return;  // says where it was before
  const bool first = stop_point_after_ == Time::min();
  stop_point_after_ = kNever;
  const double speed = std::isfinite(state_.velocity) ? std::fabs(state_.velocity) : 0.0;
  if (!first && speed <= config_.standstill_velocity) return;  // it has stopped already
  const double way = speed * speed / (2.0 * stopDeceleration(config_));
  const double ahead = (set_point_.value() - state_.position) * std::copysign(1.0, state_.velocity);
  if (first || ahead < kReachable * way) giveStopPoint(now);
}

/// The mode that brakes this one, where its target travels in every cycle.
const ModeChannel* AxisCore::brakeMode() const {
  const ModeChannel* brake = objects_.channel(mode_->spec->stop_mode);
  const bool usable = brake != nullptr && brake->target.mapped() && modeRefusal(*brake).empty();
  return usable ? brake : nullptr;
}

/// So that the mode that brakes finds the motor's own velocity as its target when it comes.
void AxisCore::followByBrakeMode() {
  const ModeChannel* brake = brakeMode();
  std::uint64_t raw = 0;
  if (brake == nullptr || !std::isfinite(state_.velocity)) return;
  if (brake->conversion.toDevice(state_.velocity, raw)) image_.setOutput(brake->target.slot, raw);
}

/// @return false if it cannot, and a quick stop has to do it
bool AxisCore::brakeByMode(Time now) {
  const ModeChannel* brake = brakeMode();
  if (brake == nullptr || !state_.feedback_valid || !std::isfinite(state_.velocity)) return false;
  const ModeChannel* pushes = mode_;
  if (pushes->target.mapped()) image_.setOutput(pushes->target.slot, 0);
  selectMode(*brake);
  braked_in_ = pushes;
  braked_at_ = now;
  const ObjectSpec* object = objects_.mode.spec;
  if (!objects_.mode.mapped() && object != nullptr) {
    const auto value = static_cast<std::uint64_t>(brake->spec->value);
    brake_ticket_ =
        device_.objects().downloadUrgent(object->id, wireBytes(value, object->type), object->name);
  }
  arrest();
  effort_streamed_ = false;
  state_.halted = true;
  state_.ready_for_motion = false;
  return true;
}

void AxisCore::arrest() {
  set_point_.arrest(state_.velocity);
  encodeTarget();
}

/// The ramp begins when the drive has taken the mode: until then it coasts.
void AxisCore::watchBrakeMode(Time now) {
  if (braking_mode_shown_) return;
  const bool refused = brake_ticket_ && brake_ticket_->done() && !brake_ticket_->ok();
  if (shown_mode_ == mode_->spec->value && !refused) {
    braking_mode_shown_ = true;
    return;
  }
  const Duration patience = profile().timing.mode_change;
  if (!refused && now <= braked_at_ + patience) {
    if (std::isfinite(state_.velocity)) arrest();
    return;
  }
  notify(who() + ": mode " + mode_->spec->name + " (6060:00 = " +
         std::to_string(mode_->spec->value) + "), which is to brake, was not taken" +
         (refused ? ": " + brake_ticket_->message() : " within " + seconds(patience)) +
         "; quick stop is commanded. " + report());
  setGoal(Goal::quick_stop);
}

void AxisCore::brakeEffort(Time now) {
  if (set_point_.atRest() && atStandstill()) {
    effort_streamed_ = false;
    return;
  }
  if (braking_ || state_.halted) return;
  set_point_.stop();
  if (stopBy() == StopBy::halt) {
    braking_ = halt_bit_ = true;
    return;
  }
  const std::string pushing = mode_->spec->name;
  if (stopBy() == StopBy::mode && brakeByMode(now)) {
    notify(who() + ": the stream of efforts ended; the axis is braked and held by mode " +
           mode_->spec->name + ". enable brings it back into " + pushing +
           ", or let it coast by command_timeout_action: coast");
    return;
  }
  setGoal(Goal::quick_stop);
  notify(who() + ": the stream of efforts ended; the axis is braked by a quick stop, as mode " +
         mode_->spec->name +
         " has no other brake. enable to go on, or let it coast by "
         "command_timeout_action: coast");
}

void AxisCore::replaceHaltedTarget() {
  if (!halt_bit_) return;  // its set-points have come to rest
  neutralizeTarget();
  if (mode_->spec->handshake == Handshake::new_set_point) handshake_.offer(target_raw_, true);
}

bool AxisCore::giveUpGoal() {
  if (!in_operation_ || halt_bit_ || !goalAhead() || !seenStill(set_point_.movedAt())) return false;
  set_point_.give(state_.position);
  set_point_.giveUp();
  return true;
}

void AxisCore::releaseHalt() {
  halt_bit_ = state_.halted = braking_ = false;
  stop_point_after_ = kNever;
}

void AxisCore::watchFollowing(Time now) {
  const auto& bit = mode_->spec->follows_command_bit;
  const bool active = state_.mode == mode_->spec;
  const bool shown = bit && active && ((state_.statusword >> *bit) & 1u) != 0;
  const bool held = !active || halt_bit_ || state_.internal_limit;
  const FollowWatch::Look look{set_point_, standstill_, state_, bit.has_value(), shown, held};
  if (following_.watch(look, now)) callBack();
}

void AxisCore::callBack() {
  const bool turns = set_point_.kind() == SetPointKind::velocity;
  const double ahead = turns ? set_point_.value() : set_point_.value() - state_.position;
  takeTargetBack();
  set_point_.giveUp();
  following_.end();
  if (!following_.isNews()) return;
  const bool prismatic = config_.geometry.type == AxisGeometry::Type::prismatic;
  const std::string what =
      turns ? "it is to turn at " + number(ahead) + (prismatic ? " m/s: " : " rad/s: ")
            : "its set-points run, " + length(ahead, prismatic) + " ahead: ";
  notify(who() + ": the motor stands while " + what +
         (state_.internal_limit ? "internal limit active (statusword bit 11), a limit switch or a "
                                  "position limit of the drive holds it"
                                : "the brake, a limit or the load holds it") +
         (turns ? ". The velocity is set to 0" : ". They are called back to where it stands") +
         ", and what was commanded is given up: free the axis or lead it back, then command it "
         "again");
}

}  // namespace cia402::drive
