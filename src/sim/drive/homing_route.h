// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace cia402::sim {

/// What ends a leg of a search for home. `on`: a switch becomes active, `off`: it does so no more.
enum class HomingEvent : std::uint8_t {
  negative_on,
  negative_off,
  positive_on,
  positive_off,
  home_on,
  home_off,
  index,      ///< the index pulse passes
  hard_stop,  ///< the motor pushes and does not move
};

/// An input that a search looks at.
enum class HomingInput : std::uint8_t { negative_limit, positive_limit, home_switch, none };

/// The switch of an event; none: the index pulse or a hard stop.
HomingInput inputOf(HomingEvent event);
/// Whether it is the switch becoming active.
bool isOn(HomingEvent event);

/// Motion in one direction, until something happens on the way.
struct HomingLeg {
  std::int8_t direction = 1;  ///< +1 or -1
  bool slow = false;          ///< by 6099h:2 instead of 6099h:1
  HomingEvent until = HomingEvent::home_on;
};
using HomingLegs = std::vector<HomingLeg>;

/// A homing method as a maker describes it. Home is where the last leg ends; where there are none,
/// it is the present position.
struct HomingRoute {
  HomingLegs legs;
  /// Instead, where it begins on what the first leg looks for, a switch or the index pulse.
  std::optional<HomingLegs> begun_on;
  /// Instead, from where the first leg meets a limit switch that it does not look for.
  std::optional<HomingLegs> from_limit;
  /// Instead, where the next index pulse of its first leg is nearer than that of `legs`.
  std::optional<HomingLegs> nearer;
  bool negative_fails = false;  ///< the negative limit switch is an error whenever it is active
  bool positive_fails = false;
  bool passes_limits = false;  ///< limit switches that no leg looks for are not minded

  /// Whether it looks for this switch.
  bool uses(HomingInput input) const;
};

/// As the figures of CiA 402-2 draw it; nullptr where the standard has no such method.
const HomingRoute* standardRoute(std::int64_t number);

}  // namespace cia402::sim
