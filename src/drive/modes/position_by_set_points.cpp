// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/position_by_set_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cia402::drive {
namespace {

/// From a set-point that is computed to a drive that acts on it, cycles.
constexpr int kTaken = 3;
/// What the drive may brake harder by where it must, times the acceleration limit; as a quick stop.
constexpr double kHardest = 2.0;
/// What is measured of the speed of a motor that brakes may be so old, cycles,
constexpr double kMeasured = 1.0;
/// and needs no more than this, of the limit, to be judged by it.
constexpr double kMore = 1.1;
/// A drive that acknowledges by a level is waited for, cycles.
constexpr int kAnswers = 3;
/// The motor is behind what its drive demands of it, cycles.
constexpr int kBehind = 1;
/// A motor that catches up, and a set-point that is late, need some of the way more; cycles.
constexpr int kSpare = 1;
/// Of slowest(), what a stream is followed with that is about to turn.
constexpr double kCreeps = 0.1;

/// How long the handshake takes from one set-point to the next, as far as the host has it in hand.
Duration handshakeOf(const Handover& handover, Duration cycle) {
  const bool level = handover.acknowledge == Handover::Acknowledge::level;
  const int further = level ? 2 + kAnswers : handover.each_for == 1 ? 0 : 2;
  return (static_cast<int>(handover.words.size()) * handover.each_for + further) * cycle;
}

}  // namespace

PositionBySetPoints::PositionBySetPoints(const ModeChannel& channel, const Context& context)
    : CyclicPosition(channel, context),
      stream_(context.axis.config.set_point_stream.value_or(*channel.spec->set_point_stream)),
      handshake_(channel.spec->handover),
      cycle_s_(toSeconds(context.axis.config.cycle)),
      ramp_(stopDeceleration(context.axis.config)),
      period_s_(std::max(stream_.interval,
                         toSeconds(handshakeOf(spec().handover, context.axis.config.cycle)))),
      reaction_s_(period_s_ + (kTaken + kBehind - kReactionCycles) * cycle_s_),
      lead_s_(reaction_s_ + kSpare * cycle_s_) {
  handOverEachCycle();
}

void PositionBySetPoints::place() {
  CyclicPosition::place();
  held_ = coming_.target = kUnknown;  // of another zero
}

void PositionBySetPoints::reset(std::uint64_t raw) {
  ramp_ = stopDeceleration(axis().config);
  handshake_.reset(raw);
  coming_ = {kUnknown, usual(), ramp_};
  rest_raw_ = raw;
  rests_ = true;
  held_ = kUnknown;
  velocity_ = acceleration_ = 0.0;
  next_ = Time::min();
  stops_after_ = kNever;
}

/// What is to count though it may be the same as before.
void PositionBySetPoints::offer(std::uint64_t /*raw*/, bool twice) {
  if (twice && sent().atRest()) called_back_ = true;
}

double PositionBySetPoints::fastest() const {
  return limits().velocity.value_or(std::numeric_limits<double>::infinity());
}

/// Of a way that no stream gives a speed for: what a third of a second brings it to.
double PositionBySetPoints::usual() const { return std::min(fastest(), ramp_ / 3.0); }

/// For the last bit of a way: a speed of 0 is none for a drive.
double PositionBySetPoints::slowest() const { return 0.5 * lead_s_ * ramp_; }

void PositionBySetPoints::watchStream() {
  const double velocity = sent().velocity();
  acceleration_ = std::clamp((velocity - velocity_) / cycle_s_, -ramp_, ramp_);
  velocity_ = velocity;
}

/// At its end: what was sent is the mean of a cycle.
double PositionBySetPoints::velocityNow() const {
  const double now = velocity_ + 0.5 * acceleration_ * cycle_s_;
  return now * velocity_ > 0.0 ? now : 0.0;
}

/// It keeps all of its reaction behind the stream: while it is slow, or cannot brake harder.
bool PositionBySetPoints::yields() const {
  return !channel().set_point_deceleration.output.mapped() ||
         std::fabs(velocity_) < ramp_ * reaction_s_;
}

/// What is measured now is where the set-point of two cycles ago was to bring the motor. It stays
/// behind that by as much as it needs to stop by its ramps where the stream stops, though it hears
/// of that late.
double PositionBySetPoints::awayFromDue() const {
  const double reaction = yields() ? std::fabs(velocity_) : ramp_ * reaction_s_;
  const double behind =
      kReactionCycles * cycle_s_ * velocity_ + std::copysign(reaction * reaction_s_, velocity_);
  return sent().value() - behind - state().position;
}

/// Where the motor will be when the drive takes a set-point that is given now, and how fast: it
/// goes on to the one before.
PositionBySetPoints::Taken PositionBySetPoints::taken() const {
  const double time = kTaken * cycle_s_;
  const double velocity = std::isfinite(state().velocity) ? state().velocity : velocity_;
  const double way = std::isfinite(coming_.target) ? coming_.target - state().position : 0.0;
  const double speed = std::fabs(velocity), sign = std::copysign(1.0, speed > 0.0 ? velocity : way);
  const double left = std::max(0.0, sign * way - speed * time);
  const double wanted = std::min(coming_.speed, std::sqrt(2.0 * coming_.deceleration * left));
  const double then =
      std::clamp(wanted, std::max(0.0, speed - coming_.deceleration * time), speed + ramp_ * time);
  return {state().position + 0.5 * sign * (speed + then) * time, sign * then};
}

/// No faster than it can brake from by the limit, until `target`; and what it brakes by, harder
/// where it is too fast for that already.
void PositionBySetPoints::limit(Way& way) const {
  const Taken from = taken();
  const double ahead = way.target - from.position, left = std::fabs(ahead);
  way.speed = std::min(way.speed, std::sqrt(2.0 * ramp_ * left));
  way.deceleration = ramp_;
  const double speed = std::fabs(from.velocity) - kMeasured * cycle_s_ * ramp_;
  if (speed <= 0.0) return;
  const double hardest = kHardest * ramp_;
  const bool passes = ahead * from.velocity <= 0.0;
  const double needed = passes ? hardest : std::min(hardest, speed * speed / (2.0 * left));
  if (needed > kMore * ramp_) way.deceleration = needed;
}

/// Where the stream would come to rest from where it is going to be when the next set-point is
/// taken, and the speed that brings the motor along it until then.
PositionBySetPoints::Way PositionBySetPoints::ahead() const {
  const double velocity = velocityNow(), rate = acceleration_;
  const bool turns = velocity * (velocity + rate * lead_s_) < 0.0;
  const double time = turns ? -velocity / rate : lead_s_;
  const double then = turns ? 0.0 : velocity + rate * time;
  motion::JointLimits range;
  range.lower = limits().lower;
  range.upper = limits().upper;
  const double rests = sent().value() + velocity * time + 0.5 * rate * time * time +
                       then * std::fabs(then) / (2.0 * ramp_);
  Way way;
  way.target = motion::withinReach(range, rests, sent().value());
  const double wanted = velocity + rate * (0.5 * period_s_ - (yields() ? reaction_s_ : 0.0)) +
                        stream_.catch_up * awayFromDue() / (period_s_ + kTaken * cycle_s_);
  const double sign = std::copysign(1.0, way.target - state().position);
  way.speed = sign * wanted;
  limit(way);
  way.speed = std::max(way.speed, kCreeps * slowest());
  return way;
}

/// No faster than it turns already, but never so slowly that it would not come.
PositionBySetPoints::Way PositionBySetPoints::wayToRest() const {
  const double speed = std::isfinite(state().velocity) ? std::fabs(state().velocity) : 0.0;
  const double wanted = std::fabs(sent().value() - state().position) / lead_s_;
  Way way{sent().value(), std::max(std::min(wanted, speed), slowest()), ramp_};
  limit(way);
  way.speed = std::max(way.speed, slowest());
  return way;
}

void PositionBySetPoints::offerNext(Time now) {
  if (!state().feedback_valid || !std::isfinite(sent().value())) return;
  const bool rests = sent().atRest();
  if (!rests && (now < next_ || handshake_.announced())) return;
  const Way way = rests ? wayToRest() : ahead();
  std::uint64_t raw = 0;
  if (!encode(way.target, raw)) return;
  if (rests && rests_ && raw == rest_raw_ && !called_back_) return;
  rests_ = rests;
  rest_raw_ = raw;
  offered_ = way;
  if (called_back_) offered_.speed = usual();
  handshake_.offer({raw, rests, false, called_back_});
  called_back_ = false;
}

void PositionBySetPoints::send(const ModeChannel::Offset& object, double value) {
  if (!object.output.mapped()) return;
  if (object.conversion.reversed()) value = -value;
  std::uint64_t raw = 0;
  value = std::clamp(value, object.conversion.lowest(), object.conversion.highest());
  if (object.conversion.toDevice(value, raw)) axis().image.setOutput(object.output.slot, raw);
}

void PositionBySetPoints::send(const Way& way) {
  send(channel().set_point_speed, std::min(way.speed, fastest()));
  send(channel().set_point_deceleration, way.deceleration);
}

void PositionBySetPoints::announced(Time now) {
  coming_ = offered_;
  next_ = now + fromSeconds(stream_.interval) - axis().config.cycle / 2;
  send(offered_);
}

const char* PositionBySetPoints::handOver(std::uint64_t& raw, Time now) {
  watchStream();
  if (stops_after_ != kNever) stopWhereItGoes();
  offerNext(now);
  const bool offered = handshake_.pending();
  const char* waiting = handshake_.waitingFor();
  const bool well = handshake_.advance(handshakeInput(), now, axis().profile().timing.state_change);
  if (offered && !handshake_.pending()) announced(now);
  if (handshake_.raised()) held_ = coming_.target;
  raw = handshake_.raw();
  insist(handshake_);
  if (well) return nullptr;
  sent().rest(SetPointKind::stream, state().position);
  sent().giveUp();
  reset(raw);
  return waiting;
}

/// Within what way a drive stops that turns at `speed` now, and faster until it has been told.
double PositionBySetPoints::surelyStops(double speed) const {
  const double told = reaction_s_ + kReactionCycles * cycle_s_;
  const double then = std::min(speed + ramp_ * told, std::max(speed, fastest()));
  return 0.5 * (speed + then) * told + then * then / (2.0 * ramp_);
}

/// The drive has gone on, and stands at the last set-point that it has, or comes to stand there.
/// That replaces one that it was not told to take yet, by which it would set off once more.
bool PositionBySetPoints::late(Time now) {
  const double speed = std::isfinite(state().velocity) ? state().velocity : 0.0;
  const bool moves = !sent().atRest() || std::fabs(speed) > axis().config.standstill_velocity;
  if (!moves || !state().feedback_valid) return moves;
  sent().rest(SetPointKind::stream, std::isfinite(held_) ? held_ : state().position);
  velocity_ = acceleration_ = 0.0;
  stops_after_ = now;
  return true;
}

/// After a late cycle: where the last set-point is further away than it takes to stop, it is to
/// stop before. What was measured before that cycle does not tell where that is.
void PositionBySetPoints::stopWhereItGoes() {
  if (state().stamp <= stops_after_) return;
  stops_after_ = kNever;
  if (!state().feedback_valid || !sent().atRest()) return;
  const double speed = std::isfinite(state().velocity) ? std::fabs(state().velocity) : 0.0;
  const double way = sent().value() - state().position, nearest = surelyStops(speed);
  if (std::fabs(way) <= nearest) return;
  sent().rest(SetPointKind::stream, state().position + std::copysign(nearest, way));
}

}  // namespace cia402::drive
