// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/feedback.h"

#include <cmath>

#include "common/text.h"
#include "drive/profile/fault_text.h"
#include "drive/profile/status_bits.h"
#include "drive/sentence.h"

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

Feedback::Feedback(AxisBasis& axis, Coordinates& coordinates, const ActiveMode& mode)
    : axis_(axis),
      signals_(axis.objects.signals),
      coordinates_(coordinates),
      mode_(mode),
      standstill_(axis.config.standstill_velocity,
                  signals_[SignalId::position].conversion.resolution()) {}

bool Feedback::read(Time now, const Commanded& commanded) {
  axis_.state.health = axis_.device.health();
  if (axis_.state.health != fieldbus::Health::ready) {
    forget();
    return false;
  }
  signals_.poll(now);
  readMotion(now, commanded.position);
  readState(now, commanded.handing_over);
  return true;
}

void Feedback::readState(Time now, bool handing_over) {
  AxisState& state = axis_.state;
  if (!signals_.fresh(SignalId::statusword)) {
    state.state = State::unknown;
    return forgetMotion();
  }
  const auto statusword = static_cast<std::uint16_t>(signals_.image(SignalId::statusword).raw);
  if (statusword != state.statusword || state.state == State::unknown) {
    state.statusword = statusword;
    state.state = decodeState(statusword);
    state.warning = axis_.profile().has_warning_bit && (statusword & statusword::kWarning) != 0;
    state.internal_limit = (statusword & statusword::kInternalLimit) != 0;
    unmet_ = axis_.profile().supervision.unmet(statusword, state.state == State::operation_enabled);
  }
  if (state.state != State::unknown) known_state_ = now;
  readMode();
  state.target_reached =
      state.mode != nullptr && !handing_over && bitSet(statusword, state.mode->target_reached_bit);
}

void Feedback::readMotion(Time now, double commanded) {
  AxisState& state = axis_.state;
  const fieldbus::ProcessValue& position = signals_.image(SignalId::position);
  double joint = kUnknown;
  if (signals_.fresh(SignalId::position)) {
    coordinates_.follow(position.raw);
    joint = coordinates_.toJoint(position.raw);
  }
  if (!std::isfinite(joint)) return forgetMotion();
  const Signal& row = signals_[SignalId::position];
  state.feedback_valid = true;
  state.position = joint;
  if (position.stamp != state.stamp || !raw_known_) {
    standstill_.update(joint, position.stamp);
    raw_position_ = row.conversion.sendable(position.raw);
    raw_known_ = true;
  } else if (!axis_.image.regular(row.slot)) {
    // Its silence says that nothing changes; what may be withheld still is not known yet.
    standstill_.update(joint, now - axis_.image.interval(row.slot, axis_.config.cycle));
  }
  state.stamp = position.stamp;
  state.velocity = signals_.read(SignalId::velocity, state.stamps.velocity);
  state.effort = signals_.read(SignalId::effort, state.stamps.effort);
  readFollowingError(commanded);
  readDigitalInputs();
}

/// By the drive where it tells it, else by what is commanded.
void Feedback::readFollowingError(double commanded) {
  AxisState& state = axis_.state;
  const Signal& row = signals_[SignalId::following_error];
  Time& stamp = state.stamps.following_error;
  if (row.value->valid) {
    state.following_error = signals_.read(SignalId::following_error, stamp);
  } else if (row.asked->fresh) {
    state.following_error = row.conversion.toJoint(row.asked->raw);
    stamp = row.asked->stamp;
  } else {
    state.following_error = commanded - state.position;
    if (!std::isnan(commanded)) stamp = state.stamp;
  }
}

void Feedback::readDigitalInputs() {
  const fieldbus::ProcessValue* told = signals_.told(SignalId::digital_inputs);
  AxisState& state = axis_.state;
  state.digital_inputs_valid = told != nullptr;
  state.digital_inputs = told != nullptr ? static_cast<std::uint32_t>(told->raw) : 0;
  if (told != nullptr) state.stamps.digital_inputs = told->stamp;
}

void Feedback::readMode() {
  AxisState& state = axis_.state;
  const Signal& row = signals_[SignalId::mode_display];
  if (const auto* shown = signals_.told(row)) {
    state.stamps.mode = shown->stamp;
    const bool same = shown_mode_ && shown->raw == shown_raw_ && state.mode == &mode_.spec();
    if (!same) showMode(shown->raw);
    return;
  }
  if (!row.mapped() && row.polled < 0) {
    state.stamps.mode = state.stamp;
    return showMode(static_cast<std::uint64_t>(mode_.spec().value));  // no 6061h: believe
  }
  shown_mode_.reset();
  state.mode = nullptr;
}

void Feedback::showMode(std::uint64_t raw) {
  AxisState& state = axis_.state;
  const ModeSpec& selected = mode_.spec();
  // Modes of one value differ in the driver only: the commanded one is active then.
  const bool commanded = state.mode == &selected || state.mode_value != selected.value;
  if (shown_mode_ && raw == shown_raw_ && state.mode != nullptr && commanded) return;
  const ObjectSpec* object = signals_[SignalId::mode_display].spec;
  const std::int16_t value = signedMode(raw, object != nullptr ? object->type : DataType::int16);
  shown_raw_ = raw;
  shown_mode_ = value;
  state.mode_value = value;
  const ModeChannel* channel =
      value == selected.value ? &mode_.channel() : axis_.objects.channelOfValue(value);
  state.mode = channel != nullptr ? channel->spec : nullptr;
}

void Feedback::putShownMode(std::uint64_t raw, Time now) {
  signals_.put(SignalId::mode_display, raw, now);
  if (!signals_[SignalId::mode_display].mapped()) readMode();
}

double Feedback::positionBy(const ObjectSpec& object, std::uint64_t raw) const {
  const auto conversion = Conversion::create(object, axis_.profile(), axis_.config.geometry);
  return conversion ? coordinates_.placeOf(conversion->toJoint(raw)) : kUnknown;
}

bool Feedback::heardLately(Time now) const {
  const fieldbus::Slot slot = signals_[SignalId::position].slot;
  if (!axis_.image.regular(slot)) return true;
  const Duration cycle = axis_.config.cycle;
  return now - axis_.state.stamp <= axis_.image.interval(slot, cycle) + 2 * cycle;
}

void Feedback::forgetMotion() {
  AxisState& state = axis_.state;
  if (state.feedback_valid) stood_without_power_ = axis_.powerOff() && atStandstill();
  state.feedback_valid = false;
  state.position = state.velocity = state.effort = state.following_error = kUnknown;
  raw_known_ = false;
  standstill_.reset();
}

/// A drive that sends its position on changes only has sent another one already.
void Feedback::forgetPosition() {
  const fieldbus::Slot slot = signals_[SignalId::position].slot;
  if (!axis_.deviceReady() || !axis_.image.regular(slot)) return;
  axis_.image.forget(slot);
  forgetMotion();
}

void Feedback::forget() {
  forgetMotion();
  AxisState& state = axis_.state;
  state.state = State::unknown;
  state.statusword = 0;
  state.mode = nullptr;
  state.mode_value = 0;
  shown_mode_.reset();
  state.target_reached = state.warning = state.internal_limit = false;
  state.digital_inputs = 0;
  state.digital_inputs_valid = false;
}

std::string Feedback::stateText() const {
  const AxisState& state = axis_.state;
  if (state.state == State::unknown && state.statusword == 0) return "no statusword";
  return "statusword " + hexText(state.statusword, 4) + " (" + toString(state.state) + ": " +
         statusBitsText(state.statusword, state.mode, axis_.profile().status_words) + ")";
}

std::string Feedback::text() const {
  std::string text = axis_.device.overdueText();
  if (!text.empty()) return text;
  const bool come = signals_.fresh(SignalId::statusword) && signals_.fresh(SignalId::position);
  return come ? "the position that the drive sends is no finite number" : "none has come yet";
}

std::string Feedback::coastingText() const {
  if (!axis_.state.feedback_valid) return "nothing tells whether it stands: " + text();
  return "the axis still moves (velocity " + number(axis_.state.velocity) +
         "): nothing of the drive brakes it";
}

std::string Feedback::unknownText() const {
  const AxisState& state = axis_.state;
  const bool known = state.feedback_valid && state.state != State::unknown;
  if (!axis_.deviceReady() || known) return {};
  if (state.feedback_valid) {
    return axis_.who() + ": its state is unknown: statusword (" + axis_.profile().address(0x6041) +
           ") " + hexText(state.statusword, 4) + " is none of the states of CiA 402 (" +
           statusBitsText(state.statusword, state.mode, axis_.profile().status_words) +
           "); is it the right drive profile?";
  }
  std::string why = axis_.device.missingText();
  if (why.empty()) why = text();
  return axis_.who() + ": its state is unknown: no usable " + axis_.profile().feedbackObjects() +
         ": " + why + "; check cable, bus load and the drive's " + axis_.device.terms().input + "s";
}

}  // namespace cia402::drive
