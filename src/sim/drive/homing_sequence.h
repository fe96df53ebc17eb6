// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/drive/homing_switches.h"

namespace cia402::sim {

/// One homing method of CiA 402-2 as the standard's figures draw it: which switch edge, crossed in
/// which direction, and where the search begins while the switch is not active.
struct HomingMethod {
  std::int8_t number = 0;  ///< 6098h
  HomingSwitch edge = HomingSwitch::none;
  std::int8_t crossing = 0;       ///< direction in which the edge counts: +1 or -1
  std::int8_t start = 0;          ///< first direction while the switch is not active
  bool turns_at_limit = false;    ///< the limit switch in the first direction reverses the search
  bool index = false;             ///< then to the next index pulse in the crossing direction
  bool current_position = false;  ///< no motion at all (35, 37)
};

/// The method, or nullptr where the standard has none (or this simulator does not know it).
const HomingMethod* findHomingMethod(std::int64_t number);

/// Finds the home position: says in which direction to move, sees the switches pass by. Exact: the
/// edge or pulse itself is the home position, not where the rotor was seen a step later.
class HomingSequence {
 public:
  /// How far the search is.
  enum class Phase : std::uint8_t { idle, searching, found, failed };

  /// Begins at `position` (true turns).
  void start(const HomingMethod& method, const AxisSwitches& switches, double position);
  void stop() { phase_ = Phase::idle; }
  /// The rotor moved from `from` to `to`.
  void step(const AxisSwitches& switches, double from, double to);

  Phase phase() const { return phase_; }
  int direction() const { return direction_; }  ///< where to move now, +1 or -1
  bool slow() const { return slow_; }           ///< search for zero (6099h:2) instead of for switch
  double home() const { return home_; }         ///< true turns; valid in Phase::found

 private:
  void atEdge(HomingSwitch edge, int moving);
  void atLimit(const AxisSwitches& switches, double position);
  void findIndex(const AxisSwitches& switches, double from, double to);

  HomingMethod method_;
  Phase phase_ = Phase::idle;
  int direction_ = 0;
  bool slow_ = false;
  bool turned_at_limit_ = false;
  bool active_ = false;  ///< the switch, when last looked at
  bool edge_found_ = false;
  double edge_position_ = 0.0;
  double home_ = 0.0;
};

}  // namespace cia402::sim
