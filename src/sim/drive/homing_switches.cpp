// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/homing_switches.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace cia402::sim {

/// A switch as the drive takes it. @param active it is pressed
bool AxisSwitches::seen(HomingInput input, bool active) const {
  if (all_) return active;
  const auto at = std::find_if(terminals_.begin(), terminals_.end(),
                               [input](const Terminal& one) { return one.input == input; });
  return at != terminals_.end() && active != at->reversed;
}

unsigned AxisSwitches::functions(double turns) const {
  return (negativeLimit(turns) ? 1U : 0U) | (positiveLimit(turns) ? 2U : 0U) |
         (home(turns) ? 4U : 0U);
}

unsigned AxisSwitches::bits(double turns) const {
  unsigned bits = 0;
  for (const Terminal& terminal : terminals_) {
    if (terminal.bit && active(terminal.input, turns)) bits |= 1U << *terminal.bit;
  }
  return bits;
}

unsigned AxisSwitches::levels(double turns) const {
  if (all_) return functions(turns);
  if (by_bits_) return functions(turns) | bits(turns);
  unsigned bits = 0;
  for (std::size_t i = 0; i < terminals_.size(); ++i) {
    const Terminal& terminal = terminals_[i];
    const bool low = terminal.active_low && terminal.input != HomingInput::none;
    if (active(terminal.input, turns) != low) bits |= 1U << i;
  }
  return first_bit_ ? functions(turns) | bits << *first_bit_ : bits;
}

bool AxisSwitches::home(double turns) const {
  const bool pressed = mechanics_->home_switch_low < mechanics_->home_switch_high &&
                       place(turns) >= mechanics_->home_switch_low &&
                       place(turns) <= mechanics_->home_switch_high;
  return seen(HomingInput::home_switch, pressed);
}

bool AxisSwitches::active(HomingInput input, double turns) const {
  switch (input) {
    case HomingInput::negative_limit:
      return negativeLimit(turns);
    case HomingInput::positive_limit:
      return positiveLimit(turns);
    case HomingInput::home_switch:
      return home(turns);
    case HomingInput::none:
      break;
  }
  return false;
}

double AxisSwitches::edge(HomingInput input, bool low) const {
  switch (input) {
    case HomingInput::negative_limit:
      return place(mechanics_->negative_limit_switch);
    case HomingInput::positive_limit:
      return place(mechanics_->positive_limit_switch);
    case HomingInput::home_switch:
      return place(low != mirrored_ ? mechanics_->home_switch_low : mechanics_->home_switch_high);
    case HomingInput::none:
      break;
  }
  return 0.0;
}

bool AxisSwitches::atIndex(double turns) const {
  constexpr double kWidth = 1e-6;  // turns
  const double places = place(turns) - mechanics_->index_offset;
  return std::fabs(places - std::round(places)) < kWidth;
}

std::optional<double> AxisSwitches::indexBetween(double from, double to) const {
  if (from == to) return std::nullopt;
  const double offset = place(mechanics_->index_offset);  // pulses are a whole turn apart
  const double first = to > from ? std::floor(from - offset) + 1.0 : std::ceil(from - offset) - 1.0;
  const double index = first + offset;
  const bool passed = to > from ? index <= to : index >= to;
  return passed ? std::optional<double>(index) : std::nullopt;
}

}  // namespace cia402::sim
