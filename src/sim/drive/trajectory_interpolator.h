// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cia402::sim {

/// Straight lines between the set-points of cyclic synchronous position mode (60C2h). They begin
/// and end between the steps of the control loop, too: as in drives whose loop is locked to SYNC, a
/// SYNC that comes a little late or early costs no step. After the end of a line it waits where it
/// is: it does not extrapolate.
class LinearInterpolator {
 public:
  /// Stands here.
  void reset(double position);
  /// From where it is `into` seconds after the last step, 0 to kDriveStepS, to `target` in
  /// `seconds`, at least one step.
  void moveTo(double target, double seconds, double into = 0.0);
  /// One kDriveStep.
  void step();
  double position() const { return position_; }  ///< turns
  double velocity() const { return velocity_; }  ///< turns/s

 private:
  void advance(double seconds);

  double position_ = 0.0;
  double velocity_ = 0.0;
  double target_ = 0.0;
  double left_ = 0.0;  ///< s, of the line
  double into_ = 0.0;  ///< s, of the present step, that are done
};

}  // namespace cia402::sim
