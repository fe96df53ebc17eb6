// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/drive/moving_axis.h"

namespace cia402::sim {

/// Modes of a maker's own that know no states of CiA 402 (role maker_mode: 1 steps, 2 speed): an
/// input enables the motor. Steps of a distance come with the edges of another input; the speed is
/// an object's, or that of a pulse width.
class MakerModes {
 public:
  explicit MakerModes(MovingAxis& axis) : axis_(axis) {}

  /// What its inputs say: the motor is enabled, and is not to move for now.
  void setInputs(bool enabled, bool paused) {
    enabled_ = enabled;
    paused_ = paused;
  }
  /// The edge that brings a step.
  void trigger();
  /// The pulse width of the input for the speed, 0 to 1, negative for the other direction.
  void setDuty(double duty);
  /// One of these modes is chosen: commands of CiA 402 mean nothing.
  bool chosen() const { return number() != 0; }
  /// The power stage is to be on.
  bool wantsPower() const { return chosen() && enabled_; }
  bool running() const { return running_ != 0; }
  /// The power stage went on or off.
  void begin(bool on);
  void step();

 private:
  std::int64_t number() const;
  void stepDistance();
  void stepSpeed();

  MovingAxis& axis_;
  bool enabled_ = false, paused_ = false;
  std::int64_t running_ = 0;  ///< the mode in which the motor has power: another one waits
  double target_ = 0.0;       ///< true turns
  double duty_ = 0.0;
};

}  // namespace cia402::sim
