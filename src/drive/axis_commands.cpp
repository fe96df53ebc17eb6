// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the axis says: controlword, mode and targets into the process image.
#include <algorithm>
#include <cmath>

#include "axis_core.h"
#include "sentence.h"

namespace cia402::drive {

std::uint64_t AxisCore::frames(const OutputObject& object) const {
  return image_.rpdos()[object.rpdo].count;
}

std::uint64_t AxisCore::controlwordFrames() const { return frames(objects_.controlword); }

std::uint64_t AxisCore::targetFrames() const {
  return mode_->target.mapped() ? frames(mode_->target) : controlwordFrames();
}

/// Nothing that moves anything; but a drive that was found moving is not left to coast either:
/// "disable voltage" would cut its quick stop ramp short.
std::uint16_t AxisCore::silentControlword() const {
  const bool stopped = state_.state == State::quick_stop_active && atStandstill();
  if (powerOff() || stopped || state_.state == State::switched_on || faulted()) return 0;
  return controlword::kEnableVoltage;  // quick stop
}

std::uint16_t AxisCore::composeControlword() {
  if (silent_ && !fault_reset_) return silentControlword();
  // An undecodable word is no reason to switch anything off: the last command stands.
  if (state_.state != State::unknown || goal_ != Goal::enabled) {
    command_ = nextCommand(state_.state, goal_);
    base_controlword_ = command_.controlword;
  }
  unsigned word = base_controlword_;
  if (fault_reset_) word |= controlword::kFaultReset;
  if (in_operation_) {
    word |= mode_->spec->controlword_bits;
    if (mode_->spec->handshake == Handshake::new_set_point) {
      word |= controlword::kChangeImmediately;
      if (handshake_.bit()) word |= controlword::kNewSetPoint;
    }
    if (homing_start_) word |= controlword::kHomingStart;
    if (halt_bit_) word |= controlword::kHalt;
  }
  return static_cast<std::uint16_t>(word);
}

void AxisCore::writeCommands(Time now) {
  if (in_operation_) {
    writeTarget(now);
  } else {
    writeNeutralTargets();
  }
  written_ = now;
  controlword_ = composeControlword();
  image_.setOutput(objects_.controlword.slot, controlword_);
  if (objects_.mode.mapped()) {
    image_.setOutput(objects_.mode.slot, static_cast<std::uint64_t>(mode_->spec->value));
  }
  for (const Held& held : held_) image_.setOutput(held.slot, held.raw);
}

void AxisCore::writeTarget(Time now) {
  const Duration dt = now - written_;
  if (setPointsRunFree()) beginRamp();
  if (ramping_) {
    advanceRamp(dt);
  } else if (dt > Duration::zero()) {
    target_velocity_ = (target_ - previous_target_) / toSeconds(dt);
    previous_target_ = target_;
  }
  if (mode_->spec->handshake == Handshake::new_set_point) advanceHandshake(now);
  if (!mode_->target.mapped()) return;
  const bool by_hand = mode_->spec->handshake == Handshake::new_set_point;
  image_.setOutput(mode_->target.slot, by_hand ? handshake_.raw() : target_raw_);
}

bool AxisCore::neutralTarget(const ModeChannel& mode, std::uint64_t& raw) const {
  raw = 0;
  if (mode.spec->kind != ControlKind::position) return true;
  if (!neutral_known_) return false;
  if (mode.copies_position) {
    raw = neutral_raw_;
    return true;
  }
  return mode.conversion.toDevice(objects_.position.conversion.toJoint(neutral_raw_), raw);
}

void AxisCore::writeNeutralTargets() {
  for (const ModeChannel& channel : objects_.modes) {
    std::uint64_t raw = 0;
    if (channel.target.mapped() && neutralTarget(channel, raw)) {
      image_.setOutput(channel.target.slot, raw);
    }
  }
}

void AxisCore::presetTarget(const ModeChannel& mode) {
  if (!mode.target.mapped()) return;
  if (mode.target.slot == mode_->target.slot) {
    neutralizeTarget();
    return;
  }
  std::uint64_t raw = 0;
  if (neutralTarget(mode, raw)) image_.setOutput(mode.target.slot, raw);
}

void AxisCore::neutralizeTarget() {
  ramping_ = false;
  target_ = mode_->spec->kind == ControlKind::position ? state_.position : 0.0;
  if (!neutralTarget(*mode_, target_raw_) && mode_->target.mapped()) {
    target_raw_ = image_.output(mode_->target.slot);
  }
  previous_target_ = target_;
  target_velocity_ = 0.0;
  set_point_dropped_ = false;
  handshake_.reset(target_raw_);
}

void AxisCore::selectMode(const ModeChannel& mode) {
  mode_ = &mode;
  held_.clear();
  mode_conversion_ = mode.spec->kind == ControlKind::position ? mode.conversion.shifted(zero_shift_)
                                                              : mode.conversion;
  homing_start_ = false;
  neutralizeTarget();
}

void AxisCore::holdOutput(canopen::Slot slot, std::uint64_t raw) {
  for (Held& held : held_) {
    if (held.slot == slot) {
      held.raw = raw;
      return;
    }
  }
  held_.push_back({slot, raw});
}

bool AxisCore::homedEnough() const {
  return state_.homed || mode_->spec->kind != ControlKind::position || absolute();
}

bool AxisCore::withinLimits(double value) const {
  const AxisLimits& limits = config_.limits;
  switch (mode_->spec->kind) {
    case ControlKind::position:  // an axis that stands outside may come back, not go further out
      return !(limits.lower && value < std::min(*limits.lower, target_)) &&
             !(limits.upper && value > std::max(*limits.upper, target_));
    case ControlKind::velocity:
      if (limits.velocity && std::fabs(value) > *limits.velocity) return false;
      if (!state_.homed) return true;
      // Beyond a limit it may only get slower or turn back.
      return !(limits.lower && state_.position <= *limits.lower && value < 0.0 &&
               !(value > target_)) &&
             !(limits.upper && state_.position >= *limits.upper && value > 0.0 &&
               !(value < target_));
    case ControlKind::torque:
      return !(limits.effort && std::fabs(value) > *limits.effort);
    case ControlKind::homing:
      return false;
  }
  return false;
}

bool AxisCore::setTarget(double value) {
  if (!std::isfinite(value) || !state_.ready_for_motion || !homedEnough() || !withinLimits(value)) {
    return false;
  }
  std::uint64_t raw = 0;
  if (!mode_->target.mapped() || !mode_conversion_.toDevice(value, raw)) return false;
  const bool changed = raw != target_raw_ || set_point_dropped_;
  set_point_dropped_ = false;
  target_ = value;
  target_raw_ = raw;
  if (changed && mode_->spec->handshake == Handshake::new_set_point) handshake_.offer(raw);
  return true;
}

void AxisCore::advanceHandshake(Time now) {
  SetPointHandshake::Input input;
  input.target_frames = targetFrames();
  input.controlword_frames = controlwordFrames();
  const std::optional<int>& bit = mode_->spec->set_point_acknowledge_bit;
  input.has_acknowledge = bit.has_value();
  input.acknowledged = bit && ((static_cast<unsigned>(state_.statusword) >> *bit) & 1u) != 0;
  const char* waiting = handshake_.waitingFor();
  if (handshake_.advance(input, now, profile().timing.state_change)) return;
  notify(who() + ": the drive did not take the set-point " + number(target_) + ": waited " +
         seconds(profile().timing.state_change) + " for " + waiting + "; " + report());
  set_point_dropped_ = true;
}

void AxisCore::beginHalt() {
  if (!in_operation_) return;
  halted_ = true;
  state_.ready_for_motion = false;
  if (profile().halt_supported && !mode_->spec->cyclic) {
    halt_bit_ = true;
    return;
  }
  beginRamp();
}

bool AxisCore::setPointsRunFree() const {
  if (state_.ready_for_motion || ramping_ || halted_) return false;
  switch (mode_->spec->kind) {
    case ControlKind::position:
      return mode_->spec->cyclic && target_velocity_ != 0.0;
    case ControlKind::velocity:
    case ControlKind::torque:
      return target_ != 0.0;
    case ControlKind::homing:
      return false;
  }
  return false;
}

void AxisCore::beginRamp() {
  const ModeSpec& spec = *mode_->spec;
  ramping_ = true;
  const double deceleration = config_.limits.acceleration.value_or(0.0);
  switch (spec.kind) {
    case ControlKind::position:
      if (!spec.cyclic) {  // the drive plans by itself: give it the point where it can stop
        target_velocity_ = std::isfinite(state_.velocity) ? state_.velocity : 0.0;
        target_ = state_.position;
      }
      ramp_.begin(target_, target_velocity_, deceleration);
      if (!spec.cyclic) ramp_.advance(std::chrono::hours(1));
      break;
    case ControlKind::velocity:
      ramp_.begin(0.0, target_, deceleration);
      break;
    case ControlKind::torque:
    case ControlKind::homing:
      ramp_.begin(0.0, 0.0, deceleration);
      break;
  }
}

void AxisCore::advanceRamp(Duration dt) {
  ramp_.advance(dt);
  const AxisLimits& limits = config_.limits;
  switch (mode_->spec->kind) {
    case ControlKind::position: {
      double position = ramp_.position();
      if (limits.lower) position = std::max(position, std::min(*limits.lower, target_));
      if (limits.upper) position = std::min(position, std::max(*limits.upper, target_));
      target_ = position;
      break;
    }
    case ControlKind::velocity:
      target_ = ramp_.velocity();
      break;
    case ControlKind::torque:
    case ControlKind::homing:
      target_ = 0.0;
      break;
  }
  std::uint64_t raw = target_raw_;
  if (!mode_conversion_.toDevice(target_, raw)) return;
  if (raw != target_raw_ && mode_->spec->handshake == Handshake::new_set_point) {
    handshake_.offer(raw);
  }
  target_raw_ = raw;
  if (!ramp_.finished() || halted_) return;
  ramping_ = false;
  previous_target_ = target_;
  target_velocity_ = 0.0;
}

void AxisCore::replaceHaltedTarget() {
  neutralizeTarget();
  if (mode_->spec->handshake == Handshake::new_set_point) handshake_.offer(target_raw_);
}

void AxisCore::releaseHalt() { halt_bit_ = halted_ = ramping_ = false; }

void AxisCore::forgetFault() {
  emergency_code_ = 0;
  read_error_code_.reset();
  error_ticket_.reset();
  state_.error_code = 0;
}

}  // namespace cia402::drive
