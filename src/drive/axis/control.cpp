// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/control.h"

namespace cia402::drive {

Control::Control(AxisBasis& axis, const Feedback& feedback)
    : axis_(axis),
      feedback_(feedback),
      brake_release_(axis.profile().timing.brake_release),
      power_off_(axis.profile().timing.power_off) {}

void Control::aim(Goal goal) {
  silent_ = voltage_off_ = false;
  goal_ = goal;
}

void Control::switchOff() {
  aim(Goal::disabled);
  voltage_off_ = true;
}

void Control::silence() {
  silent_ = true;
  fault_reset_ = false;
  base_ = word_ = 0;
}

void Control::enterOperation(Time now) {
  in_operation_ = true;
  bits_wait_ = kForMode | (brake_release_ > Duration(0) ? kForBrake : 0u);
  brake_released_ = now + brake_release_;
}

void Control::leaveOperation() {
  in_operation_ = homing_start_ = false;
  bits_wait_ = 0;
  brake_released_ = kNever;
  endHalt();
}

/// Nothing that moves anything; but a drive that was found moving is not left to coast either:
/// "disable voltage" would cut its quick stop ramp short.
std::uint16_t Control::silentWord() const {
  const State state = axis_.state.state;
  const bool stopped = state == State::quick_stop_active && feedback_.atStandstill() &&
                       !axis_.config.quick_stop_holds;
  const bool reacting = state == State::fault_reaction_active;
  if (axis_.powerOff() || stopped || state == State::switched_on || reacting) return 0;
  return controlword::kQuickStopCommand;
}

/// An undecodable word is no reason to switch anything off: the last command stands.
void Control::command() {
  const State state = axis_.state.state;
  if (state == State::unknown && goal_ == Goal::enabled) return;
  if (state != commanded_in_ || goal_ != commanded_for_) {
    // A fault in which there may be power is none in which an axis is let go.
    const bool maybe_powered = state == State::fault && !axis_.powerOff();
    command_ = maybe_powered ? nextCommand(State::unknown, Goal::quick_stop)
                             : nextCommand(state, goal_, axis_.config.disabling);
    commanded_in_ = state;
    commanded_for_ = goal_;
  }
  base_ = command_.controlword;
}

std::uint16_t Control::wordOutOfOperation(const ModeSpec& mode) {
  unsigned word = 0;
  if (silent_ && !fault_reset_) {
    word = silentWord();
  } else if (voltage_off_) {
    return 0;
  } else {
    command();
    word = base_ | (fault_reset_ ? controlword::kFaultReset : 0u);
  }
  // The drive may turn the motor on its way out of operation.
  const State state = axis_.state.state;
  const bool stopping =
      goal_ != Goal::enabled && (state == State::operation_enabled || state == State::unknown ||
                                 state == State::quick_stop_active);
  return static_cast<std::uint16_t>(word | (stopping ? mode.stoppingBits() : 0u));
}

void Control::write(unsigned mode_bits, const ModeSpec& mode) {
  if (in_operation_) {
    command();
    unsigned word = base_ | (bitsWait() ? 0u : mode_bits);
    if (fault_reset_) word |= controlword::kFaultReset;
    if (homing_start_) word |= controlword::kHomingStart;
    if (halt_) word |= controlword::kHalt;
    word_ = static_cast<std::uint16_t>(word);
  } else {
    word_ = wordOutOfOperation(mode);
  }
  axis_.image.setOutput(axis_.objects.controlword.slot, word_);
}

}  // namespace cia402::drive
