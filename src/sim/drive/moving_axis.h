// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/drive/demand.h"
#include "sim/drive/homing_switches.h"
#include "sim/drive/motion_limits.h"
#include "sim/drive/motor.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// What every mode of operation of one axis works on: its objects, motor, switches and limits, and
/// the demand that the mode moves.
class MovingAxis {
 public:
  /// All references must outlive it.
  MovingAxis(const DriveDefinition& drive_definition, const MotorParameters& motor_parameters,
             const AxisMechanics& mechanics, DriveValues& drive_values);
  MovingAxis(const MovingAxis&) = delete;
  MovingAxis& operator=(const MovingAxis&) = delete;

  bool inMode(ModeBehaviour behaviour) const {
    return mode != nullptr && mode->behaviour == behaviour;
  }
  /// The number of a target, as 607Eh lets it count: turns, turns/s or rated torques.
  double commanded(Role target) const;
  /// True turns of what the drive reads as `turns`, within 607Dh. Numbers that wrap around mean the
  /// nearest of all the places that read so.
  double trueTarget(double turns);
  /// Whether a limit switch forbids to go on in this direction.
  bool blocked(double direction) { return limits.blocked(direction, motor.position()); }
  /// One step of slowing down along a ramp.
  void slowDown(Ramp ramp);
  /// One step at the speed of the demand.
  void keepSpeed();
  /// The drive does not follow the targets of cyclic modes, and holds the motor.
  bool dropsTargets() const {
    return mode != nullptr && mode->bit_12 == Bit12::follows &&
           values.raw(Role::targets_dropped, 0) != 0;
  }
  /// What is added to the demand of the velocity loop and of the torque in cyclic modes (60B1h,
  /// turns/s; 60B2h, in rated torques).
  double offset(Role role) const { return values.raw(role, 0) == 0 ? 0.0 : values.get(role, 0.0); }
  /// Neither demand nor rotor moves.
  bool standing() const;

  const DriveDefinition& definition;
  DriveValues& values;
  AxisSwitches switches;
  Motor motor;
  MotionLimits limits;
  Demand demand;
  const ModeDefinition* mode = nullptr;  ///< none: it holds its position
  double frame = 0.0;                    ///< true turns where the drive's position is 0
};

}  // namespace cia402::sim
