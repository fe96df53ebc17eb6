// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the axis says: controlword, mode and targets into the process image.
#include <algorithm>
#include <cmath>

#include "axis_core.h"
#include "sentence.h"

namespace cia402::drive {
namespace {

constexpr double kFreeSpeed = 0.9;  ///< of the velocity limit, up to which an effort is as given

}  // namespace

std::uint64_t AxisCore::controlwordFrames() const { return image_.sent(objects_.controlword.slot); }

std::uint64_t AxisCore::targetFrames() const {
  return mode_->target.mapped() ? image_.sent(mode_->target.slot) : controlwordFrames();
}

/// Nothing that moves anything; but a drive that was found moving is not left to coast either:
/// "disable voltage" would cut its quick stop ramp short.
std::uint16_t AxisCore::silentControlword() const {
  const bool stopped =
      state_.state == State::quick_stop_active && atStandstill() && !config_.quick_stop_holds;
  const bool reacting = state_.state == State::fault_reaction_active;
  if (powerOff() || stopped || state_.state == State::switched_on || reacting) return 0;
  return controlword::kQuickStopCommand;
}

std::uint16_t AxisCore::composeControlword() {
  if (silent_ && !fault_reset_) return silentControlword();
  if (voltage_off_) return 0;
  // An undecodable word is no reason to switch anything off: the last command stands.
  if (state_.state != State::unknown || goal_ != Goal::enabled) {
    if (state_.state != commanded_in_ || goal_ != commanded_for_) {
      // A fault in which there may be power is none in which an axis is let go.
      const bool maybe_powered = state_.state == State::fault && !powerOff();
      command_ = maybe_powered ? nextCommand(State::unknown, Goal::quick_stop)
                               : nextCommand(state_.state, goal_);
      commanded_in_ = state_.state;
      commanded_for_ = goal_;
    }
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
  const bool by_drive = homing_start_ || set_point_.kind() == SetPointKind::goal;
  if (by_drive) watchDrive(now);
  controlword_ = composeControlword();
  image_.setOutput(objects_.controlword.slot, controlword_);
  if (objects_.mode.mapped()) {
    const int value = mode_override_.value_or(mode_->spec->value);
    image_.setOutput(objects_.mode.slot, static_cast<std::uint64_t>(value));
  }
  for (const Held& held : held_) image_.setOutput(held.slot, held.raw);
}

void AxisCore::writeTarget(Time now) {
  if (stop_point_after_ != kNever) renewStopPoint(now);
  if (set_point_.advance(now)) encodeTarget();
  if (effort_streamed_) set_point_.leased() ? followByBrakeMode() : brakeEffort(now);
  const bool by_hand = mode_->spec->handshake == Handshake::new_set_point;
  if (by_hand) advanceHandshake(now);
  if (!mode_->target.mapped()) return;
  image_.setOutput(mode_->target.slot, by_hand ? handshake_.raw() : target_raw_);
}

void AxisCore::encodeTarget() {
  std::uint64_t raw = given_raw_;
  const bool as_given = set_point_.value() == given_;
  if (!as_given && !mode_conversion_.toDevice(set_point_.value(), raw)) return;
  if (raw != target_raw_ && mode_->spec->handshake == Handshake::new_set_point) {
    handshake_.offer(raw, state_.halted);  // where the drive is stopped by it
  }
  target_raw_ = raw;
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
  const bool position = mode_->spec->kind == ControlKind::position;
  set_point_.rest(kindOf(*mode_->spec), position ? state_.position : 0.0);
  if (!neutralTarget(*mode_, target_raw_) && mode_->target.mapped()) {
    target_raw_ = image_.output(mode_->target.slot);
  }
  set_point_dropped_ = false;
  handshake_.reset(target_raw_);
}

void AxisCore::selectMode(const ModeChannel& mode) {
  mode_ = &mode;
  bound_for_ = braked_in_ = nullptr;
  braking_mode_shown_ = false;
  brake_ticket_.reset();
  mode_override_.reset();
  given_ = kUnknown;
  held_.clear();
  if (mode.spec->kind != ControlKind::homing) unwrap_.resume();
  placeZero();
  homing_start_ = false;
  endBraking();  // it belongs to the mode that is left, at rest
  neutralizeTarget();
}

void AxisCore::holdOutput(fieldbus::Slot slot, std::uint64_t raw) {
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

/// Beyond half of what the drive can count, what is sent means a place on the other side.
bool AxisCore::withinReach(double position) const {
  if (!unwrap_.counting()) return true;
  return std::fabs(position - state_.position) <
         0.5 * std::fabs(objects_.position.conversion.span());
}

/// Beyond a limit of position a velocity or effort may only get less or lead back.
bool AxisCore::leadsInside(double value) const {
  const AxisLimits& limits = config_.limits;
  if (!state_.homed) return true;
  return !(limits.lower && state_.position <= *limits.lower && value < 0.0 &&
           !(value > target())) &&
         !(limits.upper && state_.position >= *limits.upper && value > 0.0 && !(value < target()));
}

/// An effort makes a motor without load ever faster, and not every drive has a limit of speed for
/// its torque modes: from nine tenths of the limit on it gets less, at the limit it is 0.
double AxisCore::guardSpeed(double effort) const {
  if (!config_.limits.velocity || !(effort * state_.velocity > 0.0)) return effort;
  const double share = std::fabs(state_.velocity) / *config_.limits.velocity;
  return effort * std::clamp((1.0 - share) / (1.0 - kFreeSpeed), 0.0, 1.0);
}

bool AxisCore::withinLimits(double value) const {
  const AxisLimits& limits = config_.limits;
  switch (mode_->spec->kind) {
    case ControlKind::position:  // an axis that stands outside may come back, not go further out
      return withinReach(value) && !(limits.lower && value < std::min(*limits.lower, target())) &&
             !(limits.upper && value > std::max(*limits.upper, target()));
    case ControlKind::velocity:
      return !(limits.velocity && std::fabs(value) > *limits.velocity) && leadsInside(value);
    case ControlKind::torque:
      return !(limits.effort && std::fabs(value) > *limits.effort) && leadsInside(value);
    case ControlKind::homing:
      return false;
  }
  return false;
}

bool AxisCore::setTarget(double value) {
  if (!std::isfinite(value) || !state_.ready_for_motion || !homedEnough() || !withinLimits(value)) {
    return false;
  }
  if (mode_->spec->kind == ControlKind::torque) value = guardSpeed(value);
  std::uint64_t raw = 0;
  if (!mode_->target.mapped() || !mode_conversion_.toDevice(value, raw)) return false;
  if (mode_->spec->kind == ControlKind::torque) {
    effort_streamed_ = config_.brake_after_effort;
    endBraking();
  }
  if (set_point_dropped_ && raw == target_raw_) handshake_.offer(raw);  // once more
  set_point_dropped_ = false;
  set_point_.give(value);
  given_ = value;
  given_raw_ = raw;
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
  notify(who() + ": the drive did not take the set-point " + number(target()) + ": waited " +
         seconds(profile().timing.state_change) + " for " + waiting + "; " + report());
  set_point_dropped_ = true;
}

void AxisCore::forgetFault() {
  errors_.forget();
  state_.error_code = 0;
}

}  // namespace cia402::drive
