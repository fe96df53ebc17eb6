// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cia402_driver/common/time.h"

namespace cia402::motion {

/// Brings a streamed set-point to rest with constant deceleration. All numbers in joint units.
class StopRamp {
 public:
  /// Starts at `position` with `velocity` (unit/s; not finite: at rest). @param deceleration
  /// unit/s^2, > 0
  void begin(double position, double velocity, double deceleration);
  /// Advances by `dt`. Stays where it is once finished.
  void advance(Duration dt);
  /// Positions have got another zero.
  void shift(double by) { position_ += by; }
  bool finished() const { return velocity_ == 0.0; }
  double position() const { return position_; }
  double velocity() const { return velocity_; }

 private:
  double position_ = 0.0, velocity_ = 0.0, deceleration_ = 1.0;
};

}  // namespace cia402::motion
