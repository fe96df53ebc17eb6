// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace cia402::drive {

class AxisCore;

/// The other axes in the device of an axis: what is done to the device happens to all of them.
class Neighbours {
 public:
  /// @param axis must outlive this
  void add(AxisCore& axis) { all_.push_back(&axis); }
  bool any() const { return !all_.empty(); }

  /// Why the device may not be stopped, restarted or given other parameters: "right, in the same
  /// drive, may be under power: disable it first". Empty: it may.
  std::string refusal() const;
  /// What they are, behind an answer: "; in the same drive: right (operation enabled)". Empty:
  /// there are none.
  std::string text() const;

  /// As AxisCore has it, for all: the device may hold another zero now.
  void loseZero();
  void measureAnew();
  /// Control::wantPowerCycle() for all.
  void wantPowerCycle(const std::string& why);

 private:
  std::vector<AxisCore*> all_;
};

}  // namespace cia402::drive
