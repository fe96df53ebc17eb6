// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/torque_control.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cia402::drive {
namespace {

constexpr double kFreeSpeed = 0.9;    ///< of the velocity limit, up to which an effort is as given
constexpr double kBrakesAfter = 4.0;  ///< cycles: feedback under way, and the brake
constexpr double kBraked = 1.5;       ///< times the way that it takes, for a brake to be let go

}  // namespace

bool TorqueControl::accepts(double value) const {
  if (limits().effort && std::fabs(value) > *limits().effort) return false;
  return leadsInside(value) && (!stopsAtLimit() || maySlow(value));
}

bool TorqueControl::maySlow(double value) const {
  return !axis().config.brake_after_effort && value * state().velocity < 0.0;
}

bool TorqueControl::stopsAtLimit() const {
  const double velocity = state().velocity, speed = std::fabs(velocity);
  if (!state().homed || !(speed > axis().config.standstill_velocity)) return false;
  double way = speed * speed / (2.0 * stopDeceleration(axis().config)) +
               speed * kBrakesAfter * toSeconds(axis().config.cycle);
  if (!sent().leased()) way *= kBraked;
  return way > motion::room(limits(), state().position, velocity);
}

std::optional<double> TorqueControl::follow(Stream& stream, Time now) {
  const double most = limits().effort.value_or(std::numeric_limits<double>::infinity());
  const double effort = std::clamp(*stream.command, -most, most);
  stream.at_rest = effort == 0.0;
  const bool old = now - stream.commanded > axis().config.command_timeout;
  stream.dried_up = old && *stream.command != 0.0;
  if (!old) return effort;
  stream.command.reset();
  return {};
}

double TorqueControl::guarded(double value) const {
  if (!limits().velocity || !(value * state().velocity > 0.0)) return value;
  const double share = std::fabs(state().velocity) / *limits().velocity;
  return value * std::clamp((1.0 - share) / (1.0 - kFreeSpeed), 0.0, 1.0);
}

}  // namespace cia402::drive
