// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/position_control.h"

#include <algorithm>

namespace cia402::drive {

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

Duration PositionControl::wayBack(double) const { return kReactionCycles * axis().config.cycle; }

}  // namespace cia402::drive
