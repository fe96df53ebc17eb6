// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sim/drive/homing_route.h"
#include "sim/drive/homing_switches.h"

namespace cia402::sim {

/// Finds the home position along a route: says in which direction to move, sees the switches pass
/// by. Exact: the edge or pulse itself is the home position, not where the rotor was seen a step
/// later.
class HomingSequence {
 public:
  /// How far the search is.
  enum class Phase : std::uint8_t { idle, searching, found, failed };

  /// Begins at `position` (true turns). `route` must outlive the search.
  void start(const HomingRoute& route, const AxisSwitches& switches, double position);
  void stop() { phase_ = Phase::idle; }
  /// The rotor moved from `from` to `to`; `pushes`: against something that does not give way.
  void step(const AxisSwitches& switches, double from, double to, bool pushes);

  Phase phase() const { return phase_; }
  int direction() const { return leg().direction; }  ///< where to move now, +1 or -1
  bool slow() const { return leg().slow; }           ///< by 6099h:2 instead of by 6099h:1
  /// Whether the motor is to come to a hard stop.
  bool seeksStop() const { return leg().until == HomingEvent::hard_stop; }
  /// What happened last was a limit switch.
  bool atLimit() const { return at_limit_; }
  double home() const { return home_; }  ///< true turns; valid in Phase::found

 private:
  using Inputs = std::array<bool, 3>;  ///< by HomingInput

  const HomingLeg& leg() const;
  static Inputs look(const AxisSwitches& switches, double position);
  /// Where the present leg ends, if it does so on the way.
  std::optional<double> endOfLeg(const AxisSwitches& switches, double from, double to,
                                 bool pushes) const;
  void watchLimits(const Inputs& inputs);

  const HomingRoute* route_ = nullptr;
  const HomingLegs* legs_ = nullptr;
  std::size_t next_ = 0;
  Phase phase_ = Phase::idle;
  Inputs seen_{};  ///< when last looked at
  bool at_limit_ = false;
  double home_ = 0.0;
};

}  // namespace cia402::sim
