// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "sim/drive/drive.h"
#include "sim/drive/homing_route.h"

namespace cia402::sim {

/// True positions to switch states. The limit switches are active at and beyond their position, the
/// home switch between its two edges; a home switch of no width does not exist.
class AxisSwitches {
 public:
  explicit AxisSwitches(const AxisMechanics& mechanics) : mechanics_(&mechanics) {}

  /// A terminal of the drive, and which switch is there.
  struct Terminal {
    HomingInput input = HomingInput::none;
    bool active_low = false;
    bool reversed = false;        ///< the drive takes it for active where it is not
    std::optional<unsigned> bit;  ///< of levels(), which is 1 where its function is active
  };
  /// From now on a switch that is at none of these terminals does not exist.
  void connect(std::vector<Terminal> terminals) {
    terminals_ = std::move(terminals);
    all_ = false;
  }
  /// levels() are those of negative limit, positive limit and home switch as the drive takes them,
  /// and of the terminals from this bit on.
  void showFunctions(unsigned first_bit) { first_bit_ = first_bit; }
  /// levels() are those, and the bits of the terminals.
  void showBits() { by_bits_ = true; }
  /// The electrical levels of the terminals, a bit each; without connect() the bits are those of
  /// negative limit, positive limit and home switch.
  unsigned levels(double turns) const;

  /// From now on positions count the other way round; the switches stay where they are.
  void mirror(bool mirrored) { mirrored_ = mirrored; }

  bool negativeLimit(double turns) const {
    return seen(HomingInput::negative_limit, place(turns) <= mechanics_->negative_limit_switch);
  }
  bool positiveLimit(double turns) const {
    return seen(HomingInput::positive_limit, place(turns) >= mechanics_->positive_limit_switch);
  }
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
  double place(double turns) const { return mirrored_ ? -turns : turns; }
  bool seen(HomingInput input, bool active) const;
  unsigned functions(double turns) const;
  unsigned bits(double turns) const;

  const AxisMechanics* mechanics_;
  std::vector<Terminal> terminals_;
  bool all_ = true;  ///< every switch is connected
  bool mirrored_ = false;
  bool by_bits_ = false;
  std::optional<unsigned> first_bit_;
};

}  // namespace cia402::sim
