// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/stops.h"

#include <cmath>
#include <utility>

#include "drive/axis/core.h"
#include "drive/axis/words.h"
#include "drive/procedures/limits.h"
#include "drive/profile/object_value.h"
#include "drive/sentence.h"

namespace cia402::drive {

Stops::Stops(AxisCore& axis) : axis_(axis), runaway_(axis) {}

StopBy Stops::how() const { return stopBy(axis_.mode().spec(), axis_.profile()); }

void Stops::halt(Time now) {
  AxisState& state = axis_.basis().state;
  Generator& generator = axis_.generator();
  if (!axis_.control().inOperation() || state.halted) return;
  generator.stop();
  unfinished_ = Unfinished::nothing;  // it goes on with what ends a goal
  switch (how()) {
    case StopBy::halt:
      axis_.control().setHalt(true);
      break;
    case StopBy::quick_stop:
      axis_.setGoal(Goal::quick_stop);
      return;
    case StopBy::mode:
      if (!brakeByMode(now)) axis_.setGoal(Goal::quick_stop);
      return;
    case StopBy::set_points:
      // A goal that is being ended has its stop point already.
      if (!axis_.basis().ends_at_stop_point) generator.setHalted(true);
      break;
  }
  state.halted = true;
  state.ready_for_motion = false;
}

void Stops::hold(Time now) {
  halt(now);
  if (axis_.state().halted) unfinished_ = Unfinished::hold;
}

void Stops::endMotion(Duration over) {
  Generator& generator = axis_.generator();
  generator.stop(over);
  if (!generator.mode().goals() || !axis_.control().inOperation() || axis_.state().halted) return;
  const bool ahead = generator.goalAhead() || generator.handingOver();
  if (endsGoal() || (!ahead && axis_.feedback().atStandstill())) return;
  how() == StopBy::halt ? axis_.control().brake() : generator.setHalted(true);
  unfinished_ = Unfinished::goal;
  ends_until_ = kNever;
  replaced_.reset();
}

void Stops::finish(Time now) { endsGoal() ? finishGoal(now) : finishHold(); }

void Stops::finishHold() {
  if (axis_.state().halted && !axis_.feedback().atStandstill()) return;
  unfinished_ = Unfinished::nothing;
  if (axis_.state().halted) axis_.generator().takeBack();
}

void Stops::finishGoal(Time now) {
  Generator& generator = axis_.generator();
  const bool by_halt = axis_.control().braking();
  if (!by_halt && !axis_.basis().ends_at_stop_point) {  // another mode came, or the power went
    unfinished_ = Unfinished::nothing;
  } else if (!replaced_) {
    if (ends_until_ == kNever) ends_until_ = now + stopTime(axis_.config(), axis_.state().velocity);
    if (!axis_.feedback().seenToStand(now)) return now < ends_until_ ? void() : giveUpEnding();
    replaced_ = generator.targetFrames();
    by_halt ? generator.takeBack() : (void)generator.withdraw();
  } else if (!generator.handingOver() && generator.targetFrames() >= *replaced_ + kSureFrames) {
    unfinished_ = Unfinished::nothing;
    axis_.control().endBraking();
    generator.setHalted(false);
  }
}

void Stops::giveUpEnding() {
  axis_.notices().fail(axis_.who() +
                       ": the axis did not come to rest in front of the goal that was given up "
                       "(velocity " +
                       number(axis_.state().velocity) +
                       "): quick stop is commanded. See what drives it, or whether the drive takes "
                       "its halt, then enable. " +
                       report(axis_));
  axis_.setGoal(Goal::quick_stop);
}

void Stops::replaceHaltedTarget() {
  if (axis_.control().halt()) axis_.generator().takeBack();  // else set-points have come to rest
}

void Stops::endHalt() {
  axis_.control().endHalt();
  axis_.generator().setHalted(false);
  axis_.basis().state.halted = false;
}

void Stops::stopUrgently(const std::string& why) {
  if (!axis_.deviceReady() || axis_.powerOff()) return;
  const bool was_commanded = !axis_.control().silent() && axis_.goal() != Goal::disabled;
  if (!brakeUrgently()) quickStopUrgently();
  if (was_commanded) axis_.notices().fail(axis_.who() + ": " + why);
}

void Stops::quickStopUrgently() {
  urgent_ = false;
  axis_.setGoal(Goal::quick_stop);
  const ObjectSpec* object = axis_.objects().controlword.spec;
  const unsigned word = controlword::kQuickStopCommand | axis_.mode().spec().stoppingBits();
  urgent_ticket_ =
      axis_.device().objects().downloadUrgent(object->id, fieldbus::toBytes(word, 2), object->name);
}

/// @return false if nothing but a quick stop can do it
bool Stops::brakeUrgently() {
  if (urgent_) return true;
  if (how() != StopBy::mode || !axis_.control().inOperation()) return false;
  if (!brakeByMode(axis_.state().stamp)) return false;
  if (axis_.mode().travels()) writeBrakeMode();
  urgent_ = true;
  return true;
}

void Stops::judgeUrgent() {
  const fieldbus::Ticket ended = std::exchange(urgent_ticket_, nullptr);
  if (ended->ok()) return;
  axis_.notices().notify(
      axis_.who() + ": the quick stop by " + axis_.device().terms().access +
      " failed: " + ended->message() +
      "; the drive may go on: switch its power off if it does not stop by itself");
}

/// The mode that brakes this one, where its target travels in every cycle.
const ModeChannel* Stops::brakeMode() const {
  const ModeChannel* brake = axis_.objects().channel(axis_.mode().spec().stop_mode);
  const bool usable =
      brake != nullptr && brake->target.mapped() && axis_.mode().refusal(*brake).empty();
  return usable ? brake : nullptr;
}

/// So that the mode that brakes finds the motor's own velocity as its target when it comes.
void Stops::followByBrakeMode() {
  const ModeChannel* brake = brakeMode();
  const double velocity = axis_.state().velocity;
  std::uint64_t raw = 0;
  if (brake == nullptr || !std::isfinite(velocity)) return;
  followed_ = velocity;
  if (brake->conversion.toDevice(velocity, raw)) {
    axis_.device().image().setOutput(brake->target.slot, raw);
  }
}

/// @return false if it cannot, and a quick stop has to do it
bool Stops::brakeByMode(Time now) {
  const ModeChannel* brake = brakeMode();
  AxisState& state = axis_.basis().state;
  if (brake == nullptr || !state.feedback_valid || !std::isfinite(state.velocity)) return false;
  takeOver(*brake, state.velocity, now);
  return true;
}

void Stops::takeOver(const ModeChannel& brake, double velocity, Time now) {
  AxisState& state = axis_.basis().state;
  const ModeChannel& pushes = axis_.mode().channel();
  if (pushes.target.mapped()) axis_.device().image().setOutput(pushes.target.slot, 0);
  axis_.selectMode(brake);
  axis_.mode().brakeFor(pushes);
  braked_at_ = now;
  if (!axis_.mode().travels()) writeBrakeMode();
  axis_.generator().arrest(velocity);
  axis_.generator().endPushing();
  state.halted = true;
  state.ready_for_motion = false;
}

/// The active mode is the one that brakes.
void Stops::writeBrakeMode() {
  const ObjectSpec* const object = axis_.objects().mode.spec;
  if (object == nullptr) return;
  const auto value = static_cast<std::uint64_t>(axis_.mode().spec().value);
  brake_ticket_ = axis_.device().objects().downloadUrgent(
      object->id, wireBytes(value, object->type), object->name);
}

bool Stops::brakeUnheard(Time now) {
  const bool over = quick_stop_at_ != kNever;
  if (over || !axis_.control().inOperation() || !axis_.mode().travels()) return false;
  double velocity = 0.0;
  if (how() == StopBy::mode) {
    const ModeChannel* brake = brakeMode();
    if (brake == nullptr || !axis_.config().brake_after_effort) return false;
    if (axis_.generator().pushes()) velocity = followed_;  // else it was braked, and stands
    takeOver(*brake, velocity, now);
  } else if (!axis_.mode().brakes() || brake_mode_shown_) {
    return false;
  }
  quick_stop_at_ = now + axis_.profile().timing.mode_change +
                   fromSeconds(std::abs(velocity) / stopDeceleration(axis_.config()));
  return true;
}

bool Stops::brakesUnheard(Time now) {
  if (quick_stop_at_ == kNever || now > quick_stop_at_) return false;
  braked_at_ = now;  // what it shows is waited for once it is heard
  return true;
}

/// The ramp begins when the drive has taken the mode: until then it coasts.
void Stops::watchBrakeMode(Time now) {
  const bool unheard = quick_stop_at_ != kNever;
  if (unheard && brake_mode_shown_ && (axis_.feedback().atStandstill() || now > quick_stop_at_)) {
    return axis_.setGoal(Goal::quick_stop);
  }
  if (brake_mode_shown_) return;
  const ModeSpec& mode = axis_.mode().spec();
  const bool refused = brake_ticket_ && brake_ticket_->done() && !brake_ticket_->ok();
  if (axis_.feedback().shows(mode) && !refused) {
    brake_mode_shown_ = true;
    if (urgent_) quickStopUrgently();
    return;
  }
  const Duration patience = axis_.profile().timing.mode_change;
  if (!refused && now <= braked_at_ + patience) {
    const double velocity = axis_.state().velocity;
    if (std::isfinite(velocity)) axis_.generator().arrest(velocity);
    return;
  }
  axis_.notices().notify(
      axis_.who() + ": mode " + mode.name + " (" + axis_.profile().address(0x6060) + " = " +
      std::to_string(mode.value) + "), which is to brake, was not taken" +
      (refused ? ": " + brake_ticket_->message() : " within " + seconds(patience)) +
      "; quick stop is commanded. " + report(axis_));
  urgent_ ? quickStopUrgently() : axis_.setGoal(Goal::quick_stop);
}

void Stops::forgetBrakeMode() {
  brake_mode_shown_ = false;
  brake_ticket_.reset();
  quick_stop_at_ = kNever;
  urgent_ = false;
}

void Stops::watchEffort(Time now) {
  if (!axis_.generator().pushes()) return;
  axis_.generator().sent().leased() ? followByBrakeMode() : brakeEffort(now);
}

void Stops::brakeEffort(Time now) {
  Generator& generator = axis_.generator();
  if (generator.sent().atRest() && axis_.feedback().atStandstill()) return generator.endPushing();
  if (axis_.control().braking() || axis_.state().halted) return;
  generator.stop();
  const bool at_limit = generator.mode().stopsAtLimit();
  const std::string why =
      axis_.who() + ": " +
      (at_limit ? limitText(axis_.state(), axis_.config()) : "the stream of efforts ended");
  if (how() == StopBy::halt) {
    if (at_limit)
      axis_.notices().notify(why + ": it is braked. Only an effort that leads back, " +
                             "once it is slow enough, is taken");
    return axis_.control().brake();
  }
  const std::string pushing = axis_.mode().spec().name;
  const std::string remedy = at_limit ? " and then an effort that leads back bring it out of there"
                                      : " to go on, or let it coast by "
                                        "command_timeout_action: coast";
  if (how() == StopBy::mode && brakeByMode(now)) {
    axis_.notices().notify(why + "; the axis is braked and held by mode " +
                           axis_.mode().spec().name + ", enable takes it back into " + pushing +
                           ": enable" + remedy);
    return;
  }
  axis_.setGoal(Goal::quick_stop);
  axis_.notices().notify(why + "; the axis is braked by a quick stop, as mode " + pushing +
                         " has no other brake: enable" + remedy);
}

}  // namespace cia402::drive
