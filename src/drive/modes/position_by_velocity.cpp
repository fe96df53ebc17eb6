// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/position_by_velocity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cia402::drive {
namespace {

/// What another loop makes of a motor in motion is spread over this time, s.
constexpr double kRetuning = 1.0;
constexpr double kNearest = 0.5 + 1e-6;  // counts: no other one is nearer

const Conversion& measured(const AxisBasis& axis) {
  return axis.objects.signals[SignalId::position].conversion;
}

}  // namespace

PositionByVelocity::PositionByVelocity(const ModeChannel& channel, const Context& context)
    : CyclicPosition(channel, context),
      loop_(context.axis.config.position_loop.value_or(*channel.spec->position_loop)),
      wanted_(loop_),
      velocity_(channel.conversion),
      resolution_(measured(context.axis).resolution()) {
  handOverEachCycle();
}

const PositionLoop& PositionByVelocity::configured() const {
  const std::optional<PositionLoop>& of_axis = axis().config.position_loop;
  return of_axis ? *of_axis : *spec().position_loop;
}

void PositionByVelocity::retune() {
  const PositionLoop& now = configured();
  if (now.gain != wanted_.gain || now.feed_forward != wanted_.feed_forward) {
    wanted_ = now;
    retuned_s_ = kRetuning;
  }
  if (retuned_s_ <= 0.0) return;
  const double cycle = toSeconds(axis().config.cycle);
  const double share = std::min(1.0, cycle / retuned_s_);
  loop_.gain += share * (wanted_.gain - loop_.gain);
  loop_.feed_forward += share * (wanted_.feed_forward - loop_.feed_forward);
  retuned_s_ -= cycle;
}

/// Nothing of another loop is felt out of operation.
void PositionByVelocity::rest() {
  CyclicPosition::rest();
  loop_ = wanted_ = configured();
  retuned_s_ = 0.0;
}

void PositionByVelocity::place() { convertBy(coordinates().ofTarget(measured(axis()))); }

bool PositionByVelocity::neutralRaw(std::uint64_t& raw) const {
  return velocity_.toDevice(0.0, raw);
}

/// The drive acts on it in the next cycle, until the one after that: what is measured now is where
/// the set-point of two cycles ago was to bring it.
double PositionByVelocity::velocity() const {
  const SetPoint& point = sent();
  if (!state().feedback_valid || !std::isfinite(point.value())) return 0.0;
  const double due = point.value() - 2.0 * point.velocity() * toSeconds(axis().config.cycle);
  const double away = due - state().position;
  if (point.atRest() && std::fabs(away) <= kNearest * resolution_) return 0.0;
  const double fastest = limits().velocity.value_or(std::numeric_limits<double>::infinity());
  return std::clamp(leading(away), -fastest, fastest);
}

/// The loop brakes a motor by its gain times the speed at which that catches up. One that was held
/// back and is far behind catches up no faster than it can be braked from by the limit, until where
/// its set-points would come to rest from now on.
double PositionByVelocity::leading(double away) const {
  const double sign = std::copysign(1.0, away), speed = sign * sent().velocity();
  const double ahead = loop_.feed_forward * speed, wanted = ahead + loop_.gain * std::fabs(away);
  const double ramp = limits().acceleration.value_or(std::numeric_limits<double>::infinity());
  const double slow = ramp / loop_.gain;  // braked from by the limit in the loop alone
  if (loop_.gain * std::fabs(away) <= slow) return sign * wanted;
  const double square =
      2.0 * ramp * (std::fabs(away) + 2.0 * speed * toSeconds(axis().config.cycle)) +
      speed * std::fabs(speed) - slow * slow;
  return sign * std::min(wanted, std::max(ahead + slow, std::sqrt(std::max(0.0, square))));
}

const char* PositionByVelocity::handOver(std::uint64_t& raw, Time /*now*/) {
  retune();
  const double wanted = std::clamp(velocity(), velocity_.lowest(), velocity_.highest());
  if (!velocity_.toDevice(wanted, raw)) (void)neutralRaw(raw);
  return nullptr;
}

/// It went on with the last velocity, and would be turned back to a set-point that lies behind it.
bool PositionByVelocity::late(Time now) {
  const double speed = std::isfinite(state().velocity) ? state().velocity : sent().velocity();
  const bool moves = !sent().atRest() || std::fabs(speed) > axis().config.standstill_velocity;
  if (!moves || !state().feedback_valid) return moves;
  sent().overtake(state().position + speed * toSeconds(now - state().stamp), speed);
  return true;
}

}  // namespace cia402::drive
