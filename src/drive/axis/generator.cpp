// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/generator.h"

#include <algorithm>
#include <cmath>

#include "drive/profile/fault_text.h"
#include "drive/sentence.h"

namespace cia402::drive {

Generator::Generator(AxisBasis& axis, const Coordinates& coordinates, const Feedback& feedback,
                     const ActiveMode& mode, Control& control)
    : axis_(axis),
      coordinates_(coordinates),
      feedback_(feedback),
      active_(mode),
      control_(control),
      sent_(axis.config.limits, stopDeceleration(axis.config), axis.config.cycle),
      following_(axis.config.standstill_velocity, axis.config.cycle),
      commands_(axis) {
  for (const ModeChannel& channel : axis.objects.modes) {
    modes_.push_back(makeModeControl(channel, {axis_, coordinates_, feedback_, sent_}));
  }
  mode_ = &controlOf(active_.channel());
  enter();
}

ModeControl& Generator::controlOf(const ModeChannel& channel) {
  return *modes_[static_cast<std::size_t>(&channel - axis_.objects.modes.data())];
}

void Generator::enter() {
  commands_.forget();
  mode_ = &controlOf(active_.channel());
  mode_->place();
  setHalted(false);  // of an earlier time
  given_ = kUnknown;
  neutralize();
}

void Generator::leave() {
  pushes_ = false;
  following_.end();
  setHalted(false);
  mode_->reset(target_raw_);
  sent_.rest(mode_->kind(), SetPoint::kNone);
}

void Generator::neutralize() {
  sent_.adopt(axis_.config.limits, stopDeceleration(axis_.config));
  sent_.rest(mode_->kind(), mode_->neutral());
  const OutputObject& target = mode_->channel().target;
  if (!mode_->neutralRaw(target_raw_) && target.mapped()) {
    target_raw_ = axis_.image.output(target.slot);
  }
  mode_->reset(target_raw_);
}

void Generator::preset(const ModeChannel& channel) {
  if (!channel.target.mapped()) return;
  if (channel.target.slot == mode_->channel().target.slot) return neutralize();
  std::uint64_t raw = 0;
  if (controlOf(channel).neutralRaw(raw)) axis_.image.setOutput(channel.target.slot, raw);
}

std::uint64_t Generator::targetFrames() const {
  const OutputObject& target = mode_->channel().target;
  return target.mapped() ? axis_.image.sent(target.slot) : control_.frames();
}

void Generator::shiftZero(double moved) {
  mode_->place();
  commands_.forget();
  if (!mode_->positions()) return;
  sent_.shift(moved);
  given_ = kUnknown;
}

bool Generator::take(double value) {
  const bool ready = axis_.state.ready_for_motion && homedEnough();
  if (!ready || !std::isfinite(value) || !mode_->accepts(value)) return false;
  const SetPointKind kind = mode_->kind();
  if (kind == SetPointKind::torque) value = mode_->guarded(value);
  std::uint64_t raw = 0;
  if (!mode_->channel().target.mapped() || !mode_->encode(value, raw)) return false;
  if (kind == SetPointKind::torque) {
    pushes_ = axis_.config.brake_after_effort;
    control_.endBraking();
  } else if (kind == SetPointKind::goal) {
    mode_->accepted(raw, raw == target_raw_);
  }
  sent_.give(value);
  given_ = value;
  given_raw_ = raw;
  return true;
}

void Generator::stop(Duration over) {
  commands_.drop();
  sent_.stop(over);
}

void Generator::stepCommands(Time now) {
  late_ = false;
  if (!commands_.leads(sent_)) return;
  const std::optional<double> next = commands_.lead(*mode_, sent_, now);
  if (next && !take(*next)) commands_.drop();
}

void Generator::arrest(double velocity) {
  sent_.arrest(velocity);
  encode();
}

void Generator::lateCycle(Time now) {
  late_ = true;
  if (mode_->late(now)) giveUpLate();
  if (axis_.ends_at_stop_point) mode_->lateInHalt(now);
}

void Generator::giveUpLate() {
  sent_.giveUp();
  axis_.notices.notify(axis_.who() +
                       ": cycles were missed while it moved, and its drive went on with what it "
                       "was told last meanwhile (mode " +
                       mode_->spec().name +
                       "): it is brought to rest, and what was commanded is given "
                       "up. Command it again; see that nothing keeps the driver from its cycle");
}

void Generator::advance(Time now) {
  if (mode_->goals()) mode_->prepare(now);
  if (sent_.advance(now)) encode();
  axis_.moved_at = std::max(sent_.movedAt(), moved_itself_);
}

void Generator::encode() {
  std::uint64_t raw = given_raw_;
  const bool as_given = sent_.value() == given_;
  if (!as_given && !mode_->encode(sent_.value(), raw)) return;
  // Twice where the drive is stopped by it.
  if (raw != target_raw_) mode_->offer(raw, axis_.ends_at_stop_point);
  target_raw_ = raw;
}

const char* Generator::send(Time now) {
  std::uint64_t raw = target_raw_;
  const char* const missing = mode_->handsOver() ? mode_->handOver(raw, now) : nullptr;
  const OutputObject& target = mode_->channel().target;
  if (target.mapped()) axis_.image.setOutput(target.slot, raw);
  return missing;
}

void Generator::sendNeutral() {
  for (const auto& mode : modes_) {
    const OutputObject& target = mode->channel().target;
    std::uint64_t raw = 0;
    if (target.mapped() && mode->neutralRaw(raw)) axis_.image.setOutput(target.slot, raw);
    if (mode->handsOver()) mode->rest();
  }
}

/// The drive moves the axis as it sees fit, and what looks like standstill may be where it turns
/// back. A search for home does not mind that the axis was halted in another mode before.
bool Generator::movesItself() const {
  if (!control_.inOperation() || control_.halt()) return false;
  if (control_.homingStart()) return true;
  return !axis_.ends_at_stop_point && mode_->spec().target_reached_bit && goalAhead();
}

void Generator::watchDrive(Time now) {
  if (!control_.homingStart() && !mode_->handsOver()) return;
  if (!feedback_.measuredStill()) seen_moving_ = now;
  const bool turns_back = axis_.ends_at_stop_point && mode_->mayTurnBack(now, seen_moving_);
  if (movesItself() || turns_back) moved_itself_ = now;
  axis_.moved_at = std::max(sent_.movedAt(), moved_itself_);
}

bool Generator::moving() const {
  return feedback_.standstill().moving() || (control_.inOperation() && !sent_.atRest());
}

std::optional<Duration> Generator::withdraw() {
  if (!control_.inOperation() || !mode_->positions() || !axis_.state.feedback_valid) return {};
  const double away = std::fabs(target() - axis_.state.position);
  if (away <= feedback_.standstill().tolerance()) return {};
  takeBack();
  return mode_->wayBack(away);
}

void Generator::takeBack() {
  neutralize();
  mode_->offer(target_raw_, true);
}

bool Generator::giveUpGoal() {
  const bool held = control_.inOperation() && !control_.halt() && goalAhead() &&
                    feedback_.seenStill(sent_.movedAt());
  if (!held) return false;
  sent_.give(axis_.state.position);
  sent_.giveUp();
  return true;
}

void Generator::watchFollowing(Time now, bool warned) {
  const Standstill& standstill = feedback_.standstill();
  const AxisState& state = axis_.state;
  const auto& bit = mode_->spec().follows_command_bit;
  if (following_.leaves(standstill.moving(), bit.has_value(), now)) return;
  const bool active = state.mode == &mode_->spec();
  const bool shown = bit && active && ((state.statusword >> *bit) & 1u) != 0;
  const bool held = !active || control_.halt() || state.internal_limit;
  const FollowWatch::Look look{sent_, standstill, state,  bit.has_value(),
                               shown, held,       warned, handingOver()};
  if (following_.watch(look, now)) callBack(warned);
}

void Generator::callBack(bool warned) {
  const AxisState& state = axis_.state;
  const bool turns = sent_.kind() == SetPointKind::velocity;
  const double ahead = turns ? target() : target() - state.position;
  takeBack();
  sent_.giveUp();
  following_.end();
  if (!following_.isNews()) return;
  const bool prismatic = axis_.config.geometry.prismatic();
  const std::string what =
      turns ? "it is to turn at " + number(ahead) + (prismatic ? " m/s: " : " rad/s: ")
            : "its set-points run, " + length(ahead, prismatic) + " ahead: ";
  axis_.notices.notify(
      axis_.who() + ": the motor stands while " + what +
      (state.internal_limit ? "internal limit active (statusword bit 11), a limit switch or a "
                              "position limit of the drive holds it"
       : warned
           ? "the drive holds it by warning " + warningCodeText(axis_.profile(), state.error_code)
           : "the brake, a limit or the load holds it") +
      (turns ? ". The velocity is set to 0" : ". They are called back to where it stands") +
      ", and what was commanded is given up: free the axis or lead it back, then command it "
      "again");
}

}  // namespace cia402::drive
