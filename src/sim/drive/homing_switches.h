// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "sim/drive/drive.h"

namespace cia402::sim {

/// The switches that a homing method can orient itself by.
enum class HomingSwitch : std::uint8_t {
  none,
  negative_limit,
  positive_limit,
  home_low,
  home_high
};

/// True positions to switch states. The limit switches are active at and beyond their position, the
/// home switch between its two edges; a home switch of no width does not exist.
class AxisSwitches {
 public:
  explicit AxisSwitches(const AxisMechanics& mechanics) : mechanics_(&mechanics) {}

  bool negativeLimit(double turns) const { return turns <= mechanics_->negative_limit_switch; }
  bool positiveLimit(double turns) const { return turns >= mechanics_->positive_limit_switch; }
  /// Whether the home switch is active there.
  bool home(double turns) const;
  /// Is the switch that this edge belongs to active here?
  bool active(HomingSwitch edge, double turns) const;
  /// Where the edge is, turns.
  double edgePosition(HomingSwitch edge) const;
  /// The index pulse passed on the way from `from` (not included) to `to`; the first one met.
  std::optional<double> indexBetween(double from, double to) const;

 private:
  const AxisMechanics* mechanics_;
};

}  // namespace cia402::sim
