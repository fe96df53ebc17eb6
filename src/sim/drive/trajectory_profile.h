// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cia402::sim {

/// Moves `velocity` towards `target` for one kDriveStep: by `acceleration` while its magnitude
/// grows, by `deceleration` while it shrinks (6083h, 6084h; both > 0). Any unit. Passing through
/// zero takes the deceleration down to zero first.
double rampVelocity(double velocity, double target, double acceleration, double deceleration);

/// Limits of one positioning; all > 0, in turns and seconds.
struct ProfileLimits {
  double velocity = 0.0;
  double acceleration = 0.0;
  double deceleration = 0.0;
};

/// A trapezoidal velocity profile (6086h = 0) that is computed step by step and may be given a new
/// target at any time; it never overshoots a target that it can still reach.
class TrapezoidProfile {
 public:
  /// Starts from here.
  void reset(double position, double velocity);
  /// One kDriveStep towards `target`; comes to rest there exactly.
  void step(double target, const ProfileLimits& limits);
  /// One kDriveStep of slowing down to a stop.
  void stop(double deceleration);

  double position() const { return position_; }  ///< turns
  double velocity() const { return velocity_; }  ///< turns/s

 private:
  double position_ = 0.0;
  double velocity_ = 0.0;
};

}  // namespace cia402::sim
