// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "sim/definition/drive_definition.h"
#include "sim/drive/homing_sequence.h"
#include "sim/drive/motor.h"
#include "sim/drive/trajectory_interpolator.h"
#include "sim/drive/trajectory_profile.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// A condition that must hold for some time before it counts (windows of CiA 402).
class HeldCondition {
 public:
  /// One step. @return whether `condition` has held for `seconds` now.
  bool step(bool condition, double seconds) {
    held_s_ = condition ? held_s_ + kDriveStepS : 0.0;
    return condition && held_s_ > seconds;
  }
  void reset() { held_s_ = 0.0; }

 private:
  double held_s_ = 0.0;
};

/// The moving half of a drive: what the modes of operation make of the set-points, and the motor.
/// Positions inside are true turns; `frame` turns them into what the drive tells its master.
class DriveMotion {
 public:
  DriveMotion(const DriveDefinition& definition, const AxisMechanics& mechanics,
              DriveValues& values);

  /// Power stage on: demand := actual; or off: the rotor coasts.
  void powerStage(bool on);
  bool powered() const { return powered_; }
  /// The encoder's counter reads `turns` now.
  void setCounter(double turns) { frame_ = motor_.position() - turns; }

  /// Takes the mode over at once, at the present position and speed.
  void setMode(const ModeDefinition* mode);
  const ModeDefinition* mode() const { return mode_; }

  /// Slows down whatever the mode wants, then holds the position, until release().
  void stop(Ramp ramp);
  void release();
  bool stopping() const { return stop_.has_value(); }
  /// Set-points are not followed (brake still opening).
  void hold(bool on);

  /// A controlword arrived while operation was enabled already.
  void controlBits(std::uint16_t controlword, std::uint16_t previous);
  /// A new csp set-point becomes valid: it is reached `seconds` from now, which is `into` seconds
  /// after the last step.
  void cyclicTarget(double seconds, double into);

  void step();  ///< one kDriveStep
  bool atRest() const { return motor_.atRest(); }
  /// Neither demand nor rotor moves.
  bool standing() const;
  /// Bits 10-13 for the present mode; only meaningful while operation is enabled.
  std::uint16_t statusBits() const;
  /// Begins to home where an object does that instead of bit 4.
  void homeByObject();
  bool followingErrorExceeded() const { return following_error_exceeded_; }
  bool limitSwitchHit() const { return limit_switch_hit_; }
  /// Actual and demand values, inputs into the dictionary.
  void publish();

  Motor& motor() { return motor_; }
  const Motor& motor() const { return motor_; }

 private:
  struct SetPoint {
    double target = 0.0;
    ProfileLimits limits;
  };

  void takeOver();
  bool positionControlled() const;
  double deceleration(Ramp ramp) const;
  ProfileLimits profileLimits() const;
  double maxSpeed() const;
  struct Span {
    double low, high;
  };
  std::optional<Span> positionLimits() const;
  double trueTarget(double turns);
  bool blocked(double direction);

  void stepStop();
  void stepProfilePosition();
  void stepCyclicPosition();
  void stepVelocity(bool ramped);
  void stepTorque(bool ramped);
  void stepHoming(double from);
  void superviseFollowing();
  void superviseTargets();
  double limitedVelocity(double velocity, double braking);

  void acceptSetPoint(std::uint16_t controlword);
  void startHoming();
  void finishHoming();
  bool homesByObject() const { return values_.entry(Role::homing_start) != nullptr; }
  std::uint16_t homingBits() const;

  const DriveDefinition& definition_;
  const AxisMechanics& mechanics_;
  DriveValues& values_;
  AxisSwitches switches_;
  Motor motor_;
  double time_constant_;

  const ModeDefinition* mode_ = nullptr;
  bool powered_ = false;
  bool held_ = false;
  bool halted_ = false;
  std::optional<Ramp> stop_;
  double frame_ = 0.0;            ///< true turns where the drive's position is 0
  double demand_ = 0.0;           ///< true turns
  double demand_velocity_ = 0.0;  ///< turns/s
  double demand_torque_ = 0.0;    ///< rated torques

  TrapezoidProfile profile_;
  LinearInterpolator interpolator_;
  bool acknowledged_ = false;
  bool bit_4_ = false;
  SetPoint active_;
  std::optional<SetPoint> buffered_;

  HomingSequence homing_;
  bool homing_attained_ = false;
  bool homing_failed_ = false;
  bool homing_returning_ = false;
  unsigned publications_ = 0;  ///< while it homes by an object

  HeldCondition following_, position_reached_, velocity_reached_, zero_speed_;
  bool following_error_exceeded_ = false;
  bool target_reached_ = false;
  bool at_zero_speed_ = true;
  bool limited_ = false;
  bool limit_switch_hit_ = false;
};

}  // namespace cia402::sim
