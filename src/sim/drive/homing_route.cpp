// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/homing_route.h"

#include <algorithm>
#include <map>

namespace cia402::sim {
namespace {

using E = HomingEvent;

/// One homing method of CiA 402-2: which switch edge, crossed in which direction, and where the
/// search begins while the switch is not active.
struct StandardMethod {
  enum class Edge : std::uint8_t { none, negative_limit, positive_limit, home_low, home_high };

  std::int64_t number;
  Edge edge;
  std::int8_t crossing;  ///< direction in which the edge counts: +1 or -1
  std::int8_t start;     ///< first direction while the switch is not active
  bool turns_at_limit;   ///< the limit switch in the first direction reverses the search
  bool index;            ///< then to the next index pulse in the crossing direction
};
using Edge = StandardMethod::Edge;

// 1-14 are 17-30 with a search for the index pulse behind them.
constexpr StandardMethod kMethods[] = {
    {1, Edge::negative_limit, +1, -1, false, true},
    {2, Edge::positive_limit, -1, +1, false, true},
    {3, Edge::home_low, -1, +1, false, true},
    {4, Edge::home_low, +1, +1, false, true},
    {5, Edge::home_high, +1, -1, false, true},
    {6, Edge::home_high, -1, -1, false, true},
    {7, Edge::home_low, -1, +1, true, true},
    {8, Edge::home_low, +1, +1, true, true},
    {9, Edge::home_high, -1, +1, true, true},
    {10, Edge::home_high, +1, +1, true, true},
    {11, Edge::home_high, +1, -1, true, true},
    {12, Edge::home_high, -1, -1, true, true},
    {13, Edge::home_low, +1, -1, true, true},
    {14, Edge::home_low, -1, -1, true, true},
    {17, Edge::negative_limit, +1, -1, false, false},
    {18, Edge::positive_limit, -1, +1, false, false},
    {19, Edge::home_low, -1, +1, false, false},
    {20, Edge::home_low, +1, +1, false, false},
    {21, Edge::home_high, +1, -1, false, false},
    {22, Edge::home_high, -1, -1, false, false},
    {23, Edge::home_low, -1, +1, true, false},
    {24, Edge::home_low, +1, +1, true, false},
    {25, Edge::home_high, -1, +1, true, false},
    {26, Edge::home_high, +1, +1, true, false},
    {27, Edge::home_high, +1, -1, true, false},
    {28, Edge::home_high, -1, -1, true, false},
    {29, Edge::home_low, +1, -1, true, false},
    {30, Edge::home_low, -1, -1, true, false},
    {33, Edge::none, -1, -1, false, true},
    {34, Edge::none, +1, +1, false, true},
    {35, Edge::none, 0, 0, false, false},
    {37, Edge::none, 0, 0, false, false},
};

/// The direction that leads from anywhere on the active side of the switch to its edge.
std::int8_t outOf(Edge edge) {
  return edge == Edge::home_low || edge == Edge::positive_limit ? -1 : +1;
}

E onEvent(Edge edge) {
  if (edge == Edge::negative_limit) return E::negative_on;
  return edge == Edge::positive_limit ? E::positive_on : E::home_on;
}

E offEvent(Edge edge) {
  if (edge == Edge::negative_limit) return E::negative_off;
  return edge == Edge::positive_limit ? E::positive_off : E::home_off;
}

void addIndex(const StandardMethod& method, HomingLegs& legs) {
  if (method.index) legs.push_back({method.crossing, true, E::index});
}

HomingLegs fromTheSwitch(const StandardMethod& method) {
  const std::int8_t out = outOf(method.edge);
  HomingLegs legs{{out, true, offEvent(method.edge)}};
  if (method.crossing != out) legs.push_back({method.crossing, true, onEvent(method.edge)});
  addIndex(method, legs);
  return legs;
}

HomingLegs towardsTheSwitch(const StandardMethod& method, std::int8_t direction) {
  const HomingLeg first{direction, false, onEvent(method.edge)};
  const Edge near = direction > 0 ? Edge::home_low : Edge::home_high;
  HomingLegs legs;
  if (near == method.edge && direction == method.crossing) {
    addIndex(method, legs);
  } else {
    legs = fromTheSwitch(method);
  }
  legs.insert(legs.begin(), first);
  return legs;
}

HomingRoute routeOf(const StandardMethod& method) {
  HomingRoute route;
  if (method.edge == Edge::none) {
    addIndex(method, route.legs);
    return route;
  }
  route.legs = towardsTheSwitch(method, method.start);
  route.begun_on = fromTheSwitch(method);
  if (method.turns_at_limit) {
    route.from_limit = towardsTheSwitch(method, static_cast<std::int8_t>(-method.start));
  }
  return route;
}

std::map<std::int64_t, HomingRoute> standardRoutes() {
  std::map<std::int64_t, HomingRoute> routes;
  for (const StandardMethod& method : kMethods) routes[method.number] = routeOf(method);
  return routes;
}

bool looksFor(const HomingLegs& legs, HomingInput input) {
  return std::any_of(legs.begin(), legs.end(),
                     [input](const HomingLeg& leg) { return inputOf(leg.until) == input; });
}

}  // namespace

HomingInput inputOf(HomingEvent event) {
  switch (event) {
    case E::negative_on:
    case E::negative_off:
      return HomingInput::negative_limit;
    case E::positive_on:
    case E::positive_off:
      return HomingInput::positive_limit;
    case E::home_on:
    case E::home_off:
      return HomingInput::home_switch;
    case E::index:
    case E::hard_stop:
      break;
  }
  return HomingInput::none;
}

bool isOn(HomingEvent event) {
  return event == E::negative_on || event == E::positive_on || event == E::home_on;
}

bool HomingRoute::uses(HomingInput input) const {
  if (looksFor(legs, input)) return true;
  if (!from_limit || legs.empty()) return false;
  const bool forward = legs.front().direction > 0;
  return input == (forward ? HomingInput::positive_limit : HomingInput::negative_limit) ||
         looksFor(*from_limit, input);
}

const HomingRoute* standardRoute(std::int64_t number) {
  static const std::map<std::int64_t, HomingRoute> kRoutes = standardRoutes();
  const auto found = kRoutes.find(number);
  return found == kRoutes.end() ? nullptr : &found->second;
}

}  // namespace cia402::sim
