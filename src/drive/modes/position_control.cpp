// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/position_control.h"

#include <algorithm>
#include <cmath>

#include "drive/axis/standstill.h"

namespace cia402::drive {
namespace {

/// Of two places that count as one: so far from its stop point a drive may have gone beyond it.
constexpr double kOffStopPoint = 0.25;

}  // namespace

void PositionControl::place() { convertBy(coordinates().ofTarget(channel().conversion)); }

bool PositionControl::accepts(double value) const {
  const double before = sent().value();
  return coordinates().reaches(value) &&
         !(limits().lower && value < std::min(*limits().lower, before)) &&
         !(limits().upper && value > std::max(*limits().upper, before));
}

/// Where the target is coded like the position, the very number of that; it needs no zero.
bool PositionControl::neutralRaw(std::uint64_t& raw) const {
  if (!feedback().rawPosition(raw)) {
    raw = 0;
    return false;
  }
  if (channel().copies_position) return true;
  const Conversion& position = axis().objects.signals[SignalId::position].conversion;
  return channel().conversion.toDevice(position.toJoint(raw), raw);
}

SetPointHandshake::Input PositionControl::handshakeInput() const {
  const fieldbus::ProcessImage& image = axis().image;
  const OutputObject& target = channel().target;
  SetPointHandshake::Input input;
  input.controlword_frames = image.sent(axis().objects.controlword.slot);
  input.target_frames = target.mapped() ? image.sent(target.slot) : input.controlword_frames;
  input.together = !target.mapped() ||
                   image.carrierOf(axis().objects.controlword.slot) == image.carrierOf(target.slot);
  const std::optional<int>& bit = spec().set_point_acknowledge_bit;
  input.acknowledged = bit && ((static_cast<unsigned>(state().statusword) >> *bit) & 1u) != 0;
  return input;
}

void PositionControl::insist(const SetPointHandshake& handshake) const {
  const OutputObject& target = channel().target;
  if (handshake.insists() && target.mapped()) axis().image.sendAgain(target.slot);
}

bool PositionControl::comesBack(Time now, Time seen_moving) const {
  const double tolerance = feedback().standstill().tolerance();
  const double away = std::fabs(sent().value() - state().position);
  const double slow = tolerance / toSeconds(Standstill::kWindow);  // per second
  const Duration unseen = fromSeconds(slow / stopDeceleration(axis().config)) + Standstill::kWindow;
  return away > kOffStopPoint * tolerance && now < seen_moving + unseen;
}

Duration PositionControl::wayBack(double) const { return kReactionCycles * axis().config.cycle; }

}  // namespace cia402::drive
