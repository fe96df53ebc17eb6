// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How the axis comes to rest, and whether it is.
#include <cmath>

#include "axis_core.h"
#include "procedure_limits.h"
#include "sentence.h"

namespace cia402::drive {
namespace {

/// A drive may act on a set-point so many cycles after it was computed.
constexpr int kReactionCycles = 2;
/// The same for a drive that plans its motion, whose plan is ahead of the motor.
constexpr int kPlanningCycles = 4;
/// Set-points that run while the motor stands are called back after so long; sooner where the drive
/// itself says that it does not follow.
constexpr Duration kLeftBehind{std::chrono::milliseconds(150)},
    kHeld{std::chrono::milliseconds(60)}, kStuck{std::chrono::milliseconds(300)};
/// Only set-points that are so many times faster than standstill tell that a motor stays behind.
constexpr double kClearlyMoving = 3.0;
/// Of the way that braking takes, at least, a stop point is to be ahead.
constexpr double kReachable = 0.98;

}  // namespace

Duration AxisCore::stopTime() const { return drive::stopTime(config_, state_.velocity); }

bool AxisCore::atStandstill() const {
  return standstill_.still() &&
         standstill_.stillFrom() >= set_point_.movedAt() + kReactionCycles * config_.sync_period;
}

bool AxisCore::moving() const {
  return standstill_.moving() || (in_operation_ && !set_point_.atRest());
}

void AxisCore::beginHalt() {
  if (!in_operation_ || state_.halted) return;
  set_point_.stop();
  switch (stopBy()) {
    case StopBy::halt:
      halt_bit_ = true;
      break;
    case StopBy::quick_stop:
      setGoal(Goal::quick_stop);
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
/// measured, and what is measured may be old, in a late cycle. It never goes beyond its goal.
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
  if (sign * (halted_goal_ - from) >= 0.0)
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

void AxisCore::brakeEffort() {
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
  setGoal(Goal::quick_stop);
  notify(who() + ": the stream of efforts ended; the axis is braked by a quick stop, as mode " +
         mode_->spec->name +
         " has no other brake. enable to go on, or let it coast by "
         "command_timeout_action: coast");
}

void AxisCore::replaceHaltedTarget() {
  if (!halt_bit_) return;  // its set-points have come to rest
  neutralizeTarget();
  if (mode_->spec->handshake == Handshake::new_set_point) handshake_.offer(target_raw_);
}

void AxisCore::releaseHalt() {
  halt_bit_ = state_.halted = braking_ = false;
  stop_point_after_ = kNever;
}

/// Whether the drive shows that it follows; a drive that never does is waited for once.
void AxisCore::lookForFollowing(Time now) {
  const auto& bit = mode_->spec->follows_command_bit;
  const bool shown = bit && state_.mode == mode_->spec && ((state_.statusword >> *bit) & 1u) != 0;
  if (shown) follows_shown_ = true;
  if (!bit || shown || follows_never_shown_) {
    follows_ = true;
  } else if (now - in_operation_since_ >= kFollowPatience) {
    follows_ = follows_never_shown_ = true;
  }
}

/// Set-points must not run away from a motor that stands: held by its brake, at a limit switch,
/// blocked. It would leap after them when it is let go.
void AxisCore::watchFollowing(Time now) {
  if (!follows_ || (follows_never_shown_ && !follows_shown_)) lookForFollowing(now);
  const bool runs = set_point_.kind() == SetPointKind::stream && !standstill_.moving() &&
                    std::fabs(set_point_.velocity()) > kClearlyMoving * config_.standstill_velocity;
  const double ahead = set_point_.value() - state_.position;
  if (!runs) {
    running_since_ = kNever;
    const bool rests = set_point_.kind() == SetPointKind::stream && set_point_.atRest() &&
                       standstill_.still() && now - set_point_.movedAt() >= kHeld;
    const double apart = kClearlyMoving * config_.standstill_velocity * toSeconds(kHeld);
    const bool held = state_.internal_limit && std::fabs(ahead) > apart;
    if (held && rests) callBack();
    if (held && goalIsStuck(now)) {
      callBack();
      if (mode_->spec->handshake == Handshake::new_set_point) handshake_.offer(target_raw_);
    }
    if (standstill_.moving()) left_behind_ = false;
    return;
  }
  if (running_since_ == kNever) running_since_ = now;
  // What turns back towards a motor that is held would meet it at speed.
  const double usual =
      std::fabs(set_point_.velocity()) * 2 * toSeconds(kReactionCycles * config_.sync_period);
  if ((state_.internal_limit || left_behind_) && ahead * set_point_.velocity() < 0.0 &&
      std::fabs(ahead) > usual) {
    callBack();
    return;
  }
  const auto& bit = mode_->spec->follows_command_bit;
  const bool dropped = follows_shown_ && bit && ((state_.statusword >> *bit) & 1u) == 0;
  const Duration patience = state_.internal_limit || dropped ? kHeld : kLeftBehind;
  const Time begun = running_since_ + kReactionCycles * config_.sync_period;
  const bool stands = standstill_.still() && standstill_.stillFrom() >= begun;
  if (stands && now - running_since_ >= patience) callBack();
}

/// A drive that goes to a goal by itself, and stands on the way.
bool AxisCore::goalIsStuck(Time now) const {
  return set_point_.kind() == SetPointKind::goal && state_.ready_for_motion &&
         !state_.target_reached && standstill_.still() && now - set_point_.movedAt() >= kStuck;
}

void AxisCore::callBack() {
  const double ahead = set_point_.value() - state_.position;
  neutralizeTarget();
  set_point_.giveUp();
  running_since_ = kNever;
  if (std::exchange(left_behind_, true)) return;
  const bool prismatic = config_.geometry.type == AxisGeometry::Type::prismatic;
  notify(who() + ": the motor stands while its set-points run, " + length(ahead, prismatic) +
         " ahead: " +
         (state_.internal_limit ? "internal limit active (statusword bit 11), a limit switch or a "
                                  "position limit of the drive holds it"
                                : "the brake, a limit or the load holds it") +
         ". They are called back to where it stands, and what was commanded is given up");
}

}  // namespace cia402::drive
