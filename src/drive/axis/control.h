// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "drive/axis/feedback.h"

namespace cia402::drive {

/// The controlword: where the drive is to go in its state machine, and the bits that are sent while
/// it is in operation.
class Control {
 public:
  /// Both must outlive this.
  Control(AxisBasis& axis, const Feedback& feedback);

  Goal goal() const { return goal_; }
  /// Wants the drive to go there, from the next controlword on.
  void aim(Goal goal);
  /// Disable voltage, also where the drive's state is not known; until the next goal.
  void switchOff();
  /// The device is another one, or gone: nobody has asked for anything since.
  void silence();
  /// Nobody has asked for anything since the device came: the controlword is that of silence.
  bool silent() const { return silent_; }
  /// Somebody wants it to move, or to be ready for that.
  bool commanded() const { return goal_ != Goal::disabled && goal_ != Goal::quick_stop; }

  /// The drive is to be switched off and on before it is enabled. @param why in words
  void wantPowerCycle(std::string why) {
    power_cycle_after_ = axis_.device.bootUps();
    power_cycle_why_ = std::move(why);
  }
  bool wantsPowerCycle() const { return power_cycle_after_ == axis_.device.bootUps(); }
  const std::string& powerCycleReason() const { return power_cycle_why_; }

  /// The drive was seen in operation enabled, as it was to be; until it leaves that.
  bool inOperation() const { return in_operation_; }
  /// @param now the time that the brake needs counts from then
  void enterOperation(Time now);
  /// In operation the drive may still be in another mode, in which the bits of the selected one
  /// mean something else (bit 4 begins a homing, or takes a set-point): they wait until it shows
  /// the selected one.
  void awaitMode() {
    if (in_operation_) bits_wait_ |= kForMode;
  }
  void leaveOperation();
  /// The time that the brake needs, from the next enabling on, s >= 0.
  void setBrakeRelease(Duration time) { brake_release_ = time; }
  Duration brakeRelease() const { return brake_release_; }
  /// How long the power may stay when operation ends, s >= 0: a brake closes first.
  void setPowerOffTime(Duration time) { power_off_ = time; }
  Duration powerOffTime() const { return power_off_; }
  /// When the brake will have had its time; kNever out of operation.
  Time brakeReleasedAt() const { return brake_released_; }
  /// The bits of the mode are not sent yet, though it is in operation.
  bool bitsWait() const { return bits_wait_ != 0; }
  /// Once, when the brake has had its time and the drive is in the mode: its bits are sent from
  /// then on, and commands count. @param shown the drive shows the mode @return true then
  bool releaseBits(Time now, bool shown) {
    const unsigned over = (now >= brake_released_ ? kForBrake : 0u) | (shown ? kForMode : 0u);
    bits_wait_ &= ~over;
    return !bitsWait();
  }
  /// In operation, and the brake has had its time.
  bool brakeReleased() const { return in_operation_ && (bits_wait_ & kForBrake) == 0; }

  void setFaultReset(bool on) { fault_reset_ = on; }
  void setHomingStart(bool on) { homing_start_ = on; }
  bool homingStart() const { return homing_start_; }
  void setHalt(bool on) {
    halt_ = on;
    braking_ = false;
  }
  bool halt() const { return halt_; }
  /// The halt bit brakes an axis whose efforts are nobody's any more.
  void brake() { braking_ = halt_ = true; }
  bool braking() const { return braking_; }
  /// Takes back the halt bit that brakes an axis at rest whose efforts have ended.
  void endBraking() {
    if (braking_) braking_ = halt_ = false;
  }
  void endHalt() { halt_ = braking_ = false; }

  /// Puts the controlword into the process image. @param mode_bits of the active mode, which count
  /// in operation, once the brake is released. @param mode the active one, whose bits may count on
  /// the way out of it, too
  void write(unsigned mode_bits, const ModeSpec& mode);
  /// How often the controlword was sent so far.
  std::uint64_t frames() const { return axis_.image.sent(axis_.objects.controlword.slot); }
  /// What was sent last, and in words: "shutdown (transition 2)".
  std::uint16_t word() const { return word_; }
  const char* text() const { return command_.text; }

 private:
  enum : unsigned { kForBrake = 1, kForMode = 2 };

  std::uint16_t silentWord() const;
  void command();
  [[gnu::cold]] std::uint16_t wordOutOfOperation(const ModeSpec& mode);

  AxisBasis& axis_;
  const Feedback& feedback_;
  Goal goal_ = Goal::disabled;
  bool silent_ = true;
  bool voltage_off_ = false;  ///< the power stage is to be off, whatever the drive shows
  bool in_operation_ = false;
  unsigned bits_wait_ = 0;  ///< for these, in operation, until releaseBits()
  bool fault_reset_ = false, homing_start_ = false, halt_ = false, braking_ = false;
  Duration brake_release_, power_off_;
  Time brake_released_ = kNever;
  Command command_ = nextCommand(State::unknown, Goal::disabled);  ///< of these two:
  State commanded_in_ = State::unknown;
  Goal commanded_for_ = Goal::disabled;
  std::uint16_t word_ = 0, base_ = 0;
  std::optional<std::uint32_t> power_cycle_after_;  ///< boot-ups seen when it was asked for:
  std::string power_cycle_why_;
};

}  // namespace cia402::drive
