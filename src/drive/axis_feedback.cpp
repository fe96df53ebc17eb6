// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the axis knows: the process image and polled objects, decoded.
#include <cmath>

#include "axis_core.h"

namespace cia402::drive {
namespace {

bool bitSet(std::uint16_t word, const std::optional<int>& bit) {
  return bit && ((static_cast<unsigned>(word) >> *bit) & 1u) != 0;
}

std::int16_t signedMode(std::uint64_t raw, DataType type) {
  if (fieldbus::sizeBits(type) == 8 && fieldbus::isSigned(type))
    return static_cast<std::int8_t>(raw);
  return static_cast<std::int16_t>(raw);
}

}  // namespace

/// As in nearly every cycle: readError() would change nothing.
inline bool AxisCore::errorFree() const {
  if (!errors_.quiet() || state_.warning || faulted()) return false;
  const InputObject& object = objects_.error_code;
  return !object.mapped() || !image_.fresh(object.slot) ||
         errors_.knows(static_cast<std::uint16_t>(image_.input(object.slot).raw));
}

void AxisCore::readFeedback(Time now) {
  state_.health = device_.health();
  if (!nodeReady()) {
    forgetFeedback();
    return;
  }
  if (poller_.due(now)) poller_.advance(device_.objects(), now);
  readMotion(now);
  readState(now);
  if (!errorFree()) readError(now);
}

void AxisCore::readState(Time now) {
  const fieldbus::ProcessValue& word = image_.input(objects_.statusword.slot);
  if (!image_.fresh(objects_.statusword.slot)) {
    state_.state = State::unknown;
    forgetMotion();
    return;
  }
  const auto statusword = static_cast<std::uint16_t>(word.raw);
  if (statusword != state_.statusword || state_.state == State::unknown) {
    state_.statusword = statusword;
    state_.state = decodeState(statusword);
    state_.warning = (statusword & statusword::kWarning) != 0;
    state_.internal_limit = (statusword & statusword::kInternalLimit) != 0;
  }
  if (state_.state != State::unknown) known_state_ = now;
  readMode(now);
  state_.target_reached = state_.mode != nullptr && !handshake_.busy() &&
                          bitSet(statusword, state_.mode->target_reached_bit);
}

void AxisCore::readMotion(Time now) {
  const fieldbus::ProcessValue& position = image_.input(objects_.position.slot);
  const bool fresh = image_.fresh(objects_.position.slot);
  if (fresh && unwrap_.update(position.raw)) placeZero();
  const double joint = fresh ? position_.toJoint(position.raw) : kUnknown;
  if (!std::isfinite(joint)) {
    forgetMotion();
    return;
  }
  state_.feedback_valid = true;
  state_.position = joint;
  if (position.stamp != state_.stamp || !neutral_known_) {
    standstill_.update(joint, position.stamp);
    neutral_raw_ = objects_.position.conversion.sendable(position.raw);
    neutral_known_ = true;
  } else if (!image_.regular(objects_.position.slot)) {
    // Its silence says that nothing changes; what may be withheld still is not known yet.
    const Duration withheld = image_.interval(objects_.position.slot, config_.sync_period);
    standstill_.update(joint, now - withheld);
  }
  state_.stamp = position.stamp;
  state_.velocity = read(objects_.velocity, polled_velocity_, now, state_.stamps.velocity);
  state_.effort = read(objects_.effort, polled_effort_, now, state_.stamps.effort);
  const InputObject& following_error = objects_.following_error;
  Time& stamp = state_.stamps.following_error;
  if (following_error.mapped() && image_.input(following_error.slot).valid) {
    state_.following_error = read(following_error, -1, now, stamp);
  } else if (const auto* polled = poller_.value(polled_following_error_, now)) {
    state_.following_error = following_error.conversion.toJoint(polled->raw);
    stamp = polled->stamp;
  } else if (in_operation_ && mode_->spec->kind == ControlKind::position) {
    state_.following_error = target() - joint;
    stamp = position.stamp;
  } else {
    state_.following_error = kUnknown;
  }
  readDigitalInputs(now);
}

void AxisCore::look() {
  const InputObject& object = objects_.following_error;
  const bool travels = object.mapped() && !image_.inputLeftOut(object.slot);
  if (!travels) poller_.look();
}

void AxisCore::readDigitalInputs(Time now) {
  const fieldbus::ProcessValue* told = this->told(objects_.digital_inputs, polled_inputs_, now);
  state_.digital_inputs_valid = told != nullptr;
  state_.digital_inputs = told != nullptr ? static_cast<std::uint32_t>(told->raw) : 0;
  if (told != nullptr) state_.stamps.digital_inputs = told->stamp;
}

double AxisCore::read(const InputObject& object, int polled, Time now, Time& stamp) const {
  const fieldbus::ProcessValue* value = told(object, polled, now);
  if (value == nullptr) return kUnknown;
  stamp = value->stamp;
  return object.conversion.toJoint(value->raw);
}

void AxisCore::readMode(Time now) {
  if (const auto* shown = told(objects_.mode_display, polled_mode_, now)) {
    state_.stamps.mode = shown->stamp;
    const bool same = shown_mode_ && shown->raw == shown_raw_ && state_.mode == mode_->spec;
    if (!same) showMode(shown->raw);
    return;
  }
  if (!objects_.mode_display.mapped() && polled_mode_ < 0) {
    state_.stamps.mode = state_.stamp;
    return showMode(static_cast<std::uint64_t>(mode_->spec->value));  // no 6061h: believe
  }
  shown_mode_.reset();
  state_.mode = nullptr;
}

void AxisCore::showMode(std::uint64_t raw) {
  // Modes of one value differ in the driver only: the commanded one is active then.
  const bool commanded = state_.mode == mode_->spec || state_.mode_value != mode_->spec->value;
  if (shown_mode_ && raw == shown_raw_ && state_.mode != nullptr && commanded) return;
  const DataType type =
      objects_.mode_display.spec != nullptr ? objects_.mode_display.spec->type : DataType::int16;
  const std::int16_t value = signedMode(raw, type);
  shown_raw_ = raw;
  shown_mode_ = value;
  state_.mode_value = value;
  const ModeChannel* channel = value == mode_->spec->value ? mode_ : objects_.channelOfValue(value);
  state_.mode = channel != nullptr ? channel->spec : nullptr;
}

void AxisCore::putShownMode(std::uint64_t raw, Time now) {
  poller_.put(polled_mode_, raw, now);
  if (!objects_.mode_display.mapped()) readMode(now);
}

void AxisCore::readError(Time now) {
  const InputObject& object = objects_.error_code;
  ErrorEvidence::Look look;
  look.faulted = faulted();
  look.warning = state_.warning;
  if (!object.mapped()) {
    look.by_sdo = object.spec;
  } else if (image_.fresh(object.slot)) {
    look.told = static_cast<std::uint16_t>(image_.input(object.slot).raw);
  }
  errors_.update(look, device_.objects(), now);
  state_.error_code = errors_.code();
}

bool AxisCore::heardLately(Time now) const {
  const fieldbus::Slot slot = objects_.position.slot;
  if (!image_.regular(slot)) return true;
  return now - state_.stamp <= image_.interval(slot, config_.sync_period) + 2 * config_.sync_period;
}

void AxisCore::forgetMotion() {
  if (state_.feedback_valid) stood_without_power_ = powerOff() && atStandstill();
  state_.feedback_valid = false;
  state_.position = state_.velocity = state_.effort = state_.following_error = kUnknown;
  neutral_known_ = false;
  standstill_.reset();
}

void AxisCore::forgetFeedback() {
  forgetMotion();
  state_.state = State::unknown;
  state_.statusword = 0;
  state_.mode = nullptr;
  state_.mode_value = 0;
  shown_mode_.reset();
  state_.target_reached = state_.warning = state_.internal_limit = false;
  state_.digital_inputs = 0;
  state_.digital_inputs_valid = false;
}

}  // namespace cia402::drive
