// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/homing_sequence.h"

#include <cmath>

namespace cia402::sim {
namespace {

constexpr HomingInput kInputs[] = {HomingInput::negative_limit, HomingInput::positive_limit,
                                   HomingInput::home_switch};

constexpr HomingLeg kNoLeg{0, false, HomingEvent::index};

std::size_t place(HomingInput input) { return static_cast<std::size_t>(input); }

bool isNearer(const HomingLegs& legs, const HomingLegs& than, const AxisSwitches& switches,
              double position) {
  const auto distance = [&](const HomingLegs& ways) {
    const double end = position + ways.front().direction;
    return std::fabs(switches.indexBetween(position, end).value_or(end) - position);
  };
  return distance(legs) < distance(than);
}

bool beginsOn(const HomingRoute& route, const AxisSwitches& switches, double position) {
  if (!route.begun_on || route.legs.empty()) return false;
  const HomingInput input = inputOf(route.legs.front().until);
  return input == HomingInput::none ? switches.atIndex(position) : switches.active(input, position);
}

}  // namespace

const HomingLeg& HomingSequence::leg() const {
  return phase_ == Phase::searching ? (*legs_)[next_] : kNoLeg;
}

HomingSequence::Inputs HomingSequence::look(const AxisSwitches& switches, double position) {
  Inputs inputs{};
  for (const HomingInput input : kInputs) inputs[place(input)] = switches.active(input, position);
  return inputs;
}

void HomingSequence::start(const HomingRoute& route, const AxisSwitches& switches,
                           double position) {
  route_ = &route;
  legs_ = beginsOn(route, switches, position) ? &*route.begun_on : &route.legs;
  if (route.nearer && isNearer(*route.nearer, route.legs, switches, position)) {
    legs_ = &*route.nearer;
  }
  next_ = 0;
  seen_ = look(switches, position);
  at_limit_ = false;
  home_ = position;
  phase_ = legs_->empty() ? Phase::found : Phase::searching;
}

std::optional<double> HomingSequence::endOfLeg(const AxisSwitches& switches, double from, double to,
                                               bool pushes) const {
  const HomingLeg& leg = this->leg();
  const bool ahead = (to - from) * leg.direction > 0.0;
  const HomingInput input = inputOf(leg.until);
  if (leg.until == HomingEvent::hard_stop) return pushes ? std::optional<double>(to) : std::nullopt;
  if (input == HomingInput::none) return ahead ? switches.indexBetween(from, to) : std::nullopt;
  const bool on = isOn(leg.until);
  if (seen_[place(input)] == on || switches.active(input, to) != on) return std::nullopt;
  const bool passed = switches.active(input, from) != on;  // else somebody has touched it
  if (!passed) return to;
  return ahead ? std::optional<double>(switches.edge(input, on == (leg.direction > 0)))
               : std::nullopt;
}

void HomingSequence::watchLimits(const Inputs& inputs) {
  const bool negative = inputs[place(HomingInput::negative_limit)];
  const bool positive = inputs[place(HomingInput::positive_limit)];
  const HomingLeg& leg = this->leg();
  const HomingEvent ahead = leg.direction > 0 ? HomingEvent::positive_on : HomingEvent::negative_on;
  const bool in_the_way = (leg.direction > 0 ? positive : negative) && leg.until != ahead;
  const bool fails = (negative && route_->negative_fails) || (positive && route_->positive_fails);
  const bool turns = in_the_way && route_->from_limit && legs_ == &route_->legs && next_ == 0;
  if (fails || (in_the_way && !turns && !route_->passes_limits)) {
    at_limit_ = true;
    phase_ = Phase::failed;
  } else if (turns) {
    at_limit_ = true;
    legs_ = &*route_->from_limit;
  }
}

void HomingSequence::step(const AxisSwitches& switches, double from, double to, bool pushes) {
  if (phase_ != Phase::searching) return;
  const Inputs now = look(switches, to);
  while (phase_ == Phase::searching) {
    const auto end = endOfLeg(switches, from, to, pushes);
    if (!end) break;
    const HomingInput input = inputOf(leg().until);
    at_limit_ = input == HomingInput::negative_limit || input == HomingInput::positive_limit;
    if (input != HomingInput::none) seen_[place(input)] = now[place(input)];
    home_ = from = *end;
    pushes = false;
    if (++next_ == legs_->size()) phase_ = Phase::found;
  }
  seen_ = now;
  if (phase_ == Phase::searching) watchLimits(now);
}

}  // namespace cia402::sim
