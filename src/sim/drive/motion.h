// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "sim/drive/cyclic_positions.h"
#include "sim/drive/homing_mode.h"
#include "sim/drive/maker_modes.h"
#include "sim/drive/motor_watch.h"
#include "sim/drive/moving_axis.h"
#include "sim/drive/profile_position.h"
#include "sim/drive/target_supervision.h"
#include "sim/drive/touch_probe.h"

namespace cia402::sim {

/// The moving half of an axis: what the modes of operation make of the set-points, stops, and the
/// motor. Positions inside are true turns; the frame of the axis turns them into what the drive
/// tells its master.
class DriveMotion {
 public:
  /// What works beside the modes of CiA 402.
  struct Parts {
    explicit Parts(MovingAxis& axis) : probes(axis), maker(axis) {}
    TouchProbes probes;
    MakerModes maker;
    MotorWatch watch;
  };

  /// All references must outlive it; `mechanics` may change meanwhile.
  DriveMotion(const DriveDefinition& definition, const MotorParameters& motor_parameters,
              const AxisMechanics& mechanics, DriveValues& values);

  /// Power stage on: demand := actual; or off: the rotor coasts.
  void powerStage(bool on);
  bool powered() const { return powered_; }
  /// The encoder's counter reads `turns` now.
  void setCounter(double turns) { axis_.frame = axis_.motor.position() - turns; }
  /// Turns from the drive's zero.
  double counter() const { return axis_.motor.position() - axis_.frame; }

  /// Takes the mode over at once, at the present position and speed; nullptr: none.
  void setMode(const ModeDefinition* mode);
  const ModeDefinition* mode() const { return axis_.mode; }

  /// Slows down whatever the mode wants, then holds the position, until release().
  /// @param commanded by a halt or a quick stop
  void stop(Ramp ramp, bool commanded);
  /// The mode has its say again.
  void release();
  bool stopping() const { return stop_.has_value(); }
  /// Set-points are not followed (brake still opening).
  void hold(bool on);

  /// A controlword arrived while operation was enabled already.
  void controlBits(std::uint16_t controlword, std::uint16_t previous);
  /// A new set-point of csp or ip becomes valid: it is reached `seconds` from now, which is `into`
  /// seconds after the last step.
  void cyclicTarget(double seconds, double into);

  void step();  ///< one kDriveStep
  /// The rotor stands, and is shown to.
  bool atRest() const {
    return axis_.motor.atRest() && parts_.watch.shown() == axis_.motor.velocity();
  }
  /// Neither demand nor rotor moves.
  bool standing() const;
  /// Bits 8 and 10 to 15 for the present mode; only meaningful while operation is enabled.
  std::uint16_t statusBits() const;
  HomingMode& homing() { return homing_; }
  bool followingErrorExceeded() const { return supervision_.followingErrorExceeded(); }
  /// The drive has found its home by itself, since its position was lost.
  bool homed() const { return axis_.limits.homed(); }
  void setHomed(bool homed) {
    homing_.forgetOffset();
    axis_.limits.setHomed(homed);
  }
  /// The drive halts the motor by itself, as by controlword bit 8, until it lets it go on.
  void pause(bool on);
  /// Ramps on the way out of operation hold their speed in velocity mode.
  void lockRamps(bool on) { ramps_locked_ = on; }
  /// The axis stands on a limit switch or beyond it.
  bool onLimitSwitch() const;
  const MotionLimits& limits() const { return axis_.limits; }
  /// Name of a fault that the mode has come to since it was asked last, or nullptr.
  const char* takeFault() { return cyclic_.takeStep() ? "position_step" : homing_.takeFault(); }
  Parts& parts() { return parts_; }
  const Parts& parts() const { return parts_; }
  /// Further bits of the inputs (60FDh) that are 1.
  void setInputs(std::uint32_t bits) { inputs_ = bits; }
  AxisSwitches& switches() { return axis_.switches; }
  /// Actual and demand values, inputs into the dictionary.
  void publish();

  Motor& motor() { return axis_.motor; }
  const Motor& motor() const { return axis_.motor; }

 private:
  bool positionControlled() const;
  bool modeBit() const;
  bool fadesInStops() const;
  std::uint16_t modeBits() const;
  void begun();
  void stepRotor(double from);
  void stepMode(double from);
  void limitTorque();
  void halt();

  const AxisMechanics& mechanics_;
  MovingAxis axis_;
  ProfilePosition set_points_{axis_};
  CyclicPositions cyclic_{axis_};
  HomingMode homing_{axis_};
  TargetSupervision supervision_{axis_};
  Parts parts_{axis_};
  double time_constant_;  ///< of the position loop, s
  bool powered_ = false;
  bool fades_ = false;  ///< the present stop lets the torque go
  bool held_ = false;
  bool halted_ = false, paused_ = false, ramps_locked_ = false;
  bool started_ = false;  ///< a set-point or a search has begun in this mode, since it began
  std::optional<Ramp> stop_;
  std::uint32_t inputs_ = 0;
  std::uint16_t controlword_ = 0;  ///< the last one in operation
};

}  // namespace cia402::sim
