// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/homing_sequence.h"

#include <algorithm>
#include <array>

namespace cia402::sim {
namespace {

using H = HomingSwitch;

// number, edge, crossing, start, turns at limit, index, current position. 1-14 are 17-30 with a
// search for the index pulse behind them (CiA 402-2, figures of the homing methods).
constexpr HomingMethod kMethods[] = {
    {1, H::negative_limit, +1, -1, false, true, false},
    {2, H::positive_limit, -1, +1, false, true, false},
    {3, H::home_low, -1, +1, false, true, false},
    {4, H::home_low, +1, +1, false, true, false},
    {5, H::home_high, +1, -1, false, true, false},
    {6, H::home_high, -1, -1, false, true, false},
    {7, H::home_low, -1, +1, true, true, false},
    {8, H::home_low, +1, +1, true, true, false},
    {9, H::home_high, -1, +1, true, true, false},
    {10, H::home_high, +1, +1, true, true, false},
    {11, H::home_high, +1, -1, true, true, false},
    {12, H::home_high, -1, -1, true, true, false},
    {13, H::home_low, +1, -1, true, true, false},
    {14, H::home_low, -1, -1, true, true, false},
    {17, H::negative_limit, +1, -1, false, false, false},
    {18, H::positive_limit, -1, +1, false, false, false},
    {19, H::home_low, -1, +1, false, false, false},
    {20, H::home_low, +1, +1, false, false, false},
    {21, H::home_high, +1, -1, false, false, false},
    {22, H::home_high, -1, -1, false, false, false},
    {23, H::home_low, -1, +1, true, false, false},
    {24, H::home_low, +1, +1, true, false, false},
    {25, H::home_high, -1, +1, true, false, false},
    {26, H::home_high, +1, +1, true, false, false},
    {27, H::home_high, +1, -1, true, false, false},
    {28, H::home_high, -1, -1, true, false, false},
    {29, H::home_low, +1, -1, true, false, false},
    {30, H::home_low, -1, -1, true, false, false},
    {33, H::none, -1, -1, false, true, false},
    {34, H::none, +1, +1, false, true, false},
    {35, H::none, 0, 0, false, false, true},
    {37, H::none, 0, 0, false, false, true},
};

bool isHomeSwitch(HomingSwitch edge) { return edge == H::home_low || edge == H::home_high; }

// The direction that leads from anywhere on the active side of the switch to its edge.
int outOf(HomingSwitch edge) { return edge == H::home_low || edge == H::positive_limit ? -1 : +1; }

}  // namespace

const HomingMethod* findHomingMethod(std::int64_t number) {
  const auto* found = std::find_if(std::begin(kMethods), std::end(kMethods),
                                   [number](const HomingMethod& m) { return m.number == number; });
  return found == std::end(kMethods) ? nullptr : found;
}

void HomingSequence::start(const HomingMethod& method, const AxisSwitches& switches,
                           double position) {
  method_ = method;
  phase_ = Phase::searching;
  turned_at_limit_ = false;
  edge_found_ = false;
  slow_ = false;
  if (method.current_position) {
    home_ = position;
    phase_ = Phase::found;
  } else if (method.edge == H::none) {
    direction_ = method.start;
    edge_found_ = true;
    edge_position_ = position;
    slow_ = true;
  } else {
    active_ = switches.active(method.edge, position);
    direction_ = active_ ? outOf(method.edge) : method.start;
    slow_ = active_;
  }
}

void HomingSequence::atEdge(HomingSwitch edge, int moving) {
  slow_ = true;
  if (edge != method_.edge) {
    direction_ = outOf(method_.edge);  // through the switch, or back to it, to its other edge
  } else if (moving == method_.crossing) {
    edge_found_ = true;
    direction_ = method_.crossing;
  } else {
    direction_ = method_.crossing;
  }
}

void HomingSequence::atLimit(const AxisSwitches& switches, double position) {
  const bool own_switch = !isHomeSwitch(method_.edge) && method_.edge != H::none;
  const bool negative = direction_ < 0 && switches.negativeLimit(position) &&
                        !(own_switch && method_.edge == H::negative_limit);
  const bool positive = direction_ > 0 && switches.positiveLimit(position) &&
                        !(own_switch && method_.edge == H::positive_limit);
  if (!negative && !positive) return;
  if (!method_.turns_at_limit || turned_at_limit_ || slow_) {
    phase_ = Phase::failed;
    return;
  }
  turned_at_limit_ = true;
  direction_ = -direction_;
}

void HomingSequence::findIndex(const AxisSwitches& switches, double from, double to) {
  const double moved = to - from;
  if (moved * method_.crossing <= 0.0) return;
  const auto index = switches.indexBetween(from, to);
  if (!index || (*index - edge_position_) * method_.crossing <= 0.0) return;
  home_ = *index;
  phase_ = Phase::found;
}

void HomingSequence::step(const AxisSwitches& switches, double from, double to) {
  if (phase_ != Phase::searching) return;
  const bool active = method_.edge != H::none && switches.active(method_.edge, to);
  if (!edge_found_ && active != active_) {
    HomingSwitch edge = method_.edge;
    const bool passed = switches.active(edge, from) != active;  // else somebody has touched it
    int moving = to > from ? 1 : -1;
    if (!passed) moving = isHomeSwitch(edge) ? direction_ : active ? -outOf(edge) : outOf(edge);
    if (isHomeSwitch(edge)) edge = active == (moving > 0) ? H::home_low : H::home_high;
    atEdge(edge, moving);
    if (edge_found_) {
      edge_position_ = passed ? switches.edgePosition(edge) : to;
      home_ = edge_position_;
      if (!method_.index) phase_ = Phase::found;
      from = edge_position_;
    }
  }
  active_ = active;
  if (phase_ == Phase::searching && edge_found_) findIndex(switches, from, to);
  if (phase_ == Phase::searching) atLimit(switches, to);
}

}  // namespace cia402::sim
