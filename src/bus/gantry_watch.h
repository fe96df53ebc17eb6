// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "bus/axis_unit.h"
#include "config/robot.h"

namespace cia402::bus {

/// Sees that the two sides of a gantry have power together, home together and stay level, by what
/// both measure. It only says so; whoever asks stops them.
class GantryWatch {
 public:
  /// @param a, @param b sides 1 and 2; must outlive this.
  GantryWatch(const config::CouplingConfig& config, AxisUnit& a, AxisUnit& b);

  /// Once a cycle, by new feedback. @return why both sides must be stopped, in words; empty if not
  std::string watch();
  /// Both are homed, and no further apart than the window.
  bool level() const { return base_ == 0.0; }
  /// Why the joint must not be moved; empty if it may.
  std::string refusal() const;

 private:
  enum class Homing : std::uint8_t { no, runs, done };
  struct Side {
    AxisUnit* unit;
    Homing homing = Homing::no;
    double position = drive::kUnknown;  ///< in the cycle before
    Time stamp{};
    std::uint32_t zeros = 0;
  };

  void measure();
  static double newZero(Side& side);
  bool homed() const;
  bool homing() const;
  bool powered() const;
  std::string alone() const;
  std::string homesAlone();
  std::string skewed() const;

  config::GantryConfig config_;
  motion::Joint joint_;
  std::array<Side, 2> sides_;
  double skew_ = drive::kUnknown;  ///< position of side 2 minus that of side 1
  double base_ = drive::kUnknown;  ///< what counts as level: 0, or as they stood without power
};

}  // namespace cia402::bus
