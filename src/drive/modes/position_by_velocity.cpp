// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/position_by_velocity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cia402::drive {
namespace {

constexpr double kNearest = 0.5 + 1e-6;  // counts: no other one is nearer

const Conversion& measured(const AxisBasis& axis) {
  return axis.objects.signals[SignalId::position].conversion;
}

}  // namespace

PositionByVelocity::PositionByVelocity(const ModeChannel& channel, const Context& context)
    : CyclicPosition(channel, context),
      loop_(context.axis.config.position_loop.value_or(*channel.spec->position_loop)),
      velocity_(channel.conversion),
      resolution_(measured(context.axis).resolution()) {
  handOverEachCycle();
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
  return std::clamp(loop_.feed_forward * point.velocity() + loop_.gain * away, -fastest, fastest);
}

const char* PositionByVelocity::handOver(std::uint64_t& raw, Time /*now*/) {
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
