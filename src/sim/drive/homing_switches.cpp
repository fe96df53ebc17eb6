// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/homing_switches.h"

#include <cmath>

namespace cia402::sim {

bool AxisSwitches::home(double turns) const {
  return mechanics_->home_switch_low < mechanics_->home_switch_high &&
         turns >= mechanics_->home_switch_low && turns <= mechanics_->home_switch_high;
}

bool AxisSwitches::active(HomingSwitch edge, double turns) const {
  switch (edge) {
    case HomingSwitch::negative_limit:
      return negativeLimit(turns);
    case HomingSwitch::positive_limit:
      return positiveLimit(turns);
    case HomingSwitch::home_low:
    case HomingSwitch::home_high:
      return home(turns);
    case HomingSwitch::none:
      break;
  }
  return false;
}

double AxisSwitches::edgePosition(HomingSwitch edge) const {
  switch (edge) {
    case HomingSwitch::negative_limit:
      return mechanics_->negative_limit_switch;
    case HomingSwitch::positive_limit:
      return mechanics_->positive_limit_switch;
    case HomingSwitch::home_low:
      return mechanics_->home_switch_low;
    case HomingSwitch::home_high:
      return mechanics_->home_switch_high;
    case HomingSwitch::none:
      break;
  }
  return 0.0;
}

std::optional<double> AxisSwitches::indexBetween(double from, double to) const {
  if (from == to) return std::nullopt;
  const double offset = mechanics_->index_offset;
  const double first = to > from ? std::floor(from - offset) + 1.0 : std::ceil(from - offset) - 1.0;
  const double index = first + offset;
  const bool passed = to > from ? index <= to : index >= to;
  return passed ? std::optional<double>(index) : std::nullopt;
}

}  // namespace cia402::sim
