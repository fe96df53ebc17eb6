// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/profile_position.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cia402::drive {
namespace {

/// As kReactionCycles, for a drive that plans its motion, whose plan is ahead of the motor.
constexpr int kPlanningCycles = 4;
/// Of the way that braking takes, at least, a stop point is to be ahead.
constexpr double kReachable = 0.98;

}  // namespace

ProfilePosition::ProfilePosition(const ModeChannel& channel, const Context& context)
    : PositionControl(channel, context),
      by_hand_(!spec().handover.words.empty()),
      handshake_(spec().handover) {}

double ProfilePosition::withinReach(double goal) const {
  motion::JointLimits range;
  range.lower = limits().lower;
  range.upper = limits().upper;
  return motion::withinReach(range, goal, state().position);
}

void ProfilePosition::beginStream(const Stream&, Time) { waiting_.clear(); }

/// The drive goes there by itself, but not beyond the limits.
void ProfilePosition::takeCommand(Stream& stream) {
  if (spec().handover.oneByOne()) {
    waiting_.add(*stream.command);
  } else {
    stream.command = withinReach(*stream.command);
  }
}

std::optional<double> ProfilePosition::follow(Stream& stream, Time) {
  stream.at_rest = state().target_reached && waiting_.empty();
  if (spec().handover.oneByOne()) return nextWaiting();
  if (sent().value() == *stream.command) return {};
  return stream.command;
}

/// The next command that waits, once the drive has taken the one before.
std::optional<double> ProfilePosition::nextWaiting() {
  if (waiting_.empty() || handshake_.busy()) return {};
  if (spec().handover.relative() && !countsFromKnown()) return {};
  const bool measured = spec().handover.from == Handover::From::position;
  double goal = waiting_.first();
  if (spec().handover.relative()) goal += measured ? state().position : sent().value();
  waiting_.removeFirst();
  goal = withinReach(goal);
  if (!measured) return goal;
  // The drive counts from where it is by then, which may be a count off.
  const double margin = 2.0 * channel().conversion.resolution();
  if (limits().upper && goal == *limits().upper) goal -= margin;
  if (limits().lower && goal == *limits().lower) goal += margin;
  return goal;
}

/// The drive counts the next distance from a place that is known here, too: the set-point before,
/// or where the axis stands.
bool ProfilePosition::countsFromKnown() {
  if (!base_) {
    std::uint64_t raw = 0;
    if (encode(sent().value(), raw)) offer(raw, false);  // "stay here"
    return false;
  }
  const Handover::From from = spec().handover.from;
  if (from == Handover::From::target) return true;
  if (goalAhead() || !feedback().standstill().still()) return false;
  if (from == Handover::From::demand) return true;
  std::uint64_t raw = 0;
  if (!neutralRaw(raw)) return false;
  base_ = raw;
  return true;
}

void ProfilePosition::reset(std::uint64_t raw) {
  handshake_.reset(raw);
  waiting_.clear();
  command_.reset();
  base_.reset();
  dropped_ = flushes_ = false;
}

/// `raw` as a distance from base_, as wide as the target.
std::uint64_t ProfilePosition::distance(std::uint64_t raw) const {
  const ObjectSpec* target = channel().target.spec;
  const unsigned bits = target != nullptr ? fieldbus::sizeBits(target->type) : 64;
  const std::uint64_t mask = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  return (raw - *base_) & mask;
}

void ProfilePosition::offer(std::uint64_t raw, bool twice) {
  if (!by_hand_) return;
  const bool command = spec().handover.oneByOne() && command_ == raw && !twice;
  const bool counted = command && spec().handover.relative() && base_;
  handshake_.offer({counted ? distance(raw) : raw, twice, command, twice});
  base_ = raw;
  command_.reset();
}

void ProfilePosition::accepted(std::uint64_t raw, bool same) {
  if (dropped_ && same) offer(raw, false);  // once more
  dropped_ = false;
  command_ = raw;
}

unsigned ProfilePosition::bits() const {
  const unsigned bits = spec().controlword_bits;
  if (!by_hand_) return bits;
  return bits | handshake_.word() | (flushes_ ? controlword::kHalt : 0u);
}

const char* ProfilePosition::handOver(std::uint64_t& raw, Time now) {
  if (!by_hand_) return nullptr;
  const char* waiting = handshake_.waitingFor();
  const bool well = handshake_.advance(handshakeInput(), now, axis().profile().timing.state_change);
  raw = handshake_.raw();
  insist(handshake_);
  flushes_ = handshake_.blocked() || (flushes_ && handshake_.busy());
  if (well) return nullptr;
  dropped_ = true;
  waiting_.clear();
  base_.reset();
  return waiting;
}

/// On the way through its queue a drive comes by places at which it has reached a target.
bool ProfilePosition::goalAhead() const {
  const double away = std::fabs(sent().value() - state().position);
  const bool reached = state().target_reached && !spec().handover.queued;
  return !reached && away > feedback().standstill().tolerance();
}

/// What the drive has planned may be on its way still: it turns round and comes back.
Duration ProfilePosition::wayBack(double away) const {
  const double speed = limits().velocity.value_or(std::numeric_limits<double>::infinity());
  const double ramp = stopDeceleration(axis().config);
  const double fastest = std::min(speed, std::sqrt(2.0 * ramp * away));
  return PositionControl::wayBack(away) + fromSeconds(3.0 * fastest / ramp + away / fastest);
}

void ProfilePosition::beginHalt() {
  halted_goal_ = sent().value();
  stop_point_after_ = Time::min();
}

void ProfilePosition::lateInHalt(Time now) {
  if (stop_point_after_ == kNever) stop_point_after_ = now;
}

void ProfilePosition::prepare(Time now) {
  if (stop_point_after_ != kNever) renewStopPoint(now);
}

/// The nearest point where it can stop, from where it is by the newest feedback. What it does until
/// it has that is added, for a point that is too near would make it turn back: it may still be
/// gaining speed, what it has planned is ahead of what is measured, and what is measured may be
/// old, in a late cycle. It never goes beyond a goal at which it can stop; one that came nearer
/// than that under way makes the drive turn back.
void ProfilePosition::giveStopPoint(Time now) {
  if (!state().feedback_valid) return;
  const Duration cycle = axis().config.cycle;
  const double velocity = std::isfinite(state().velocity) ? state().velocity : 0.0;
  const double age = toSeconds(std::max(Duration(0), now - state().stamp - cycle));
  const double from = state().position + velocity * age;
  const double sign = std::copysign(1.0, std::fabs(velocity) > axis().config.standstill_velocity
                                             ? velocity
                                             : halted_goal_ - from);
  const double reaction = toSeconds(kPlanningCycles * cycle);
  const double deceleration = stopDeceleration(axis().config), speed = std::fabs(velocity);
  const double faster =
      std::max(speed, std::min(speed + deceleration * reaction, limits().velocity.value_or(1e9)));
  const double way = faster * reaction + faster * faster / (2.0 * deceleration);
  double point = from + sign * way;
  const double slowest =
      std::max(0.0, speed - deceleration * toSeconds(kReactionCycles * cycle));  // by now
  const double needed = slowest * slowest / (2.0 * deceleration);
  const bool reachable = sign * (halted_goal_ - state().position) >= needed;
  if (reachable && sign * (halted_goal_ - from) >= 0.0)
    point = sign * std::min(sign * point, sign * halted_goal_);
  if (limits().lower) point = std::max(point, std::min(*limits().lower, from));
  if (limits().upper) point = std::min(point, std::max(*limits().upper, from));
  sent().give(point);
}

/// After a late cycle the drive may have got its stop point so late that it lies behind it.
void ProfilePosition::renewStopPoint(Time now) {
  if (state().stamp <= stop_point_after_) return;  // says where it was before
  const bool first = stop_point_after_ == Time::min();
  stop_point_after_ = kNever;
  const double speed = std::isfinite(state().velocity) ? std::fabs(state().velocity) : 0.0;
  if (!first && speed <= axis().config.standstill_velocity) return;  // it has stopped already
  const double way = speed * speed / (2.0 * stopDeceleration(axis().config));
  const double ahead = (sent().value() - state().position) * std::copysign(1.0, state().velocity);
  if (first || ahead < kReachable * way) giveStopPoint(now);
}

}  // namespace cia402::drive
