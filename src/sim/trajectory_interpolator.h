// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cia402::sim {

/// Straight lines between the set-points of cyclic synchronous position mode (60C2h). After the end
/// of a line it waits where it is: it does not extrapolate.
class LinearInterpolator {
 public:
  /// Stands here.
  void reset(double position);
  /// From the present position to `target` in `seconds`, rounded to steps, at least one.
  void moveTo(double target, double seconds);
  /// One kDriveStep.
  void step();
  double position() const { return position_; }  ///< turns
  double velocity() const { return velocity_; }  ///< turns/s

 private:
  double position_ = 0.0;
  double velocity_ = 0.0;
  double target_ = 0.0;
  long steps_left_ = 0;
};

}  // namespace cia402::sim
