// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/drive/jerk_filter.h"
#include "sim/drive/motor.h"
#include "sim/drive/trajectory_interpolator.h"
#include "sim/drive/trajectory_profile.h"

namespace cia402::sim {

/// Where a motor is to be now, how fast and with which torque, and what leads there.
struct Demand {
  double position = 0.0;            ///< true turns
  double velocity = 0.0;            ///< turns/s
  double torque = 0.0;              ///< rated torques
  TrapezoidProfile profile;         ///< of ramps and profiled targets
  LinearInterpolator interpolator;  ///< between cyclic targets
  double ramp = 0.0;                ///< turns/s, of a speed whose corners are made round
  JerkFilter corners;               ///< of that speed

  /// Goes on from where the rotor really is: there the position loop keeps its present speed.
  /// @param time_constant of that loop, s
  void takeOver(const Motor& motor, double time_constant) {
    position = motor.position() + motor.velocity() * time_constant;
    velocity = motor.velocity();
    torque = 0.0;
    begin();
  }
  /// Profile and interpolator begin at the present demand.
  void begin() {
    profile.reset(position, velocity);
    interpolator.reset(position);
    beginRamp();
  }
  /// A ramp begins at the present speed.
  void beginRamp() {
    ramp = velocity;
    corners.reset(velocity);
  }
  /// Is where the profile is.
  void followProfile() {
    position = profile.position();
    velocity = profile.velocity();
  }
};

}  // namespace cia402::sim
