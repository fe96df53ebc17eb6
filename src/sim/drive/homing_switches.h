// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sim/drive/drive.h"
#include "sim/drive/homing_route.h"

namespace cia402::sim {

/// True positions to switch states. The limit switches are active at and beyond their position, the
/// home switch between its two edges; a home switch of no width does not exist.
class AxisSwitches {
 public:
  explicit AxisSwitches(const AxisMechanics& mechanics) : mechanics_(&mechanics) {}

  bool negativeLimit(double turns) const { return turns <= mechanics_->negative_limit_switch; }
  bool positiveLimit(double turns) const { return turns >= mechanics_->positive_limit_switch; }
  /// Whether the home switch is active there.
  bool home(double turns) const;
  /// Is this switch active here? `none` never is.
  bool active(HomingInput input, double turns) const;
  /// Where the switch has an edge, turns. @param low of the home switch: the lower of its two
  double edge(HomingInput input, bool low) const;
  /// Whether the index pulse is here.
  bool atIndex(double turns) const;
  /// The index pulse passed on the way from `from` (not included) to `to`; the first one met.
  std::optional<double> indexBetween(double from, double to) const;

 private:
  const AxisMechanics* mechanics_;
};

}  // namespace cia402::sim
