// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/enable.h"

#include "drive/procedures/limits.h"
#include "drive/sentence.h"
#include "fieldbus/bytes.h"

namespace cia402::drive {

void EnableStep::enter(Phase phase, const Context& context) {
  phase_ = phase;
  since_ = context.now;
  last_ = State::unknown;
}

Outcome EnableStep::advance(const Context& context) {
  if (reason_) return explain(context);
  if (!begun_) {
    begun_ = true;
    const std::string refusal = enablingRefusal(context.axis);
    if (!refusal.empty()) return fail(context, refusal);
  }
  const bool early = phase_ == Phase::settings || phase_ == Phase::feedback;
  if (!early && context.axis.faulted()) {
    return fail(context, context.axis.faults().text());
  }
  if (!early) {
    const std::string refusal = enablingRefusal(context.axis);
    if (!refusal.empty()) return fail(context, refusal);
  }
  switch (phase_) {
    case Phase::settings: {
      const Outcome outcome = settings_.advance(context);
      if (outcome.isFailed()) return fail(context, outcome.message);
      if (!outcome.isDone()) return outcome;
      enter(Phase::feedback, context);
      context.show("reading feedback", "statusword and position from the drive");
      return awaitFeedback(context);
    }
    case Phase::feedback:
      return awaitFeedback(context);
    case Phase::standing:
      return awaitRest(context);
    case Phase::writing: {
      const Outcome outcome = writes_.advance(context);
      if (!outcome.isDone()) return outcome;
      enter(Phase::limits, context);
      context.axis.limits().renew();
      context.show("writing position limits", "the drive to take the joint's limits");
      return Outcome::running();
    }
    case Phase::limits:
      return awaitLimits(context);
    case Phase::mode:
      return awaitMode(context);
    case Phase::transitions:
      return climb(context);
    case Phase::shown:
      return awaitShown(context);
    case Phase::brake:
      return awaitBrake(context);
  }
  return Outcome::running();
}

Outcome EnableStep::awaitFeedback(const Context& context) {
  if (context.axis.state().feedback_valid) {
    enter(Phase::standing, context);
    context.show("waiting for standstill", "the axis to stand, before the power comes");
    return awaitRest(context);
  }
  const Duration waited = context.now - since_;
  if (waited <= context.axis.profile().timing.state_change) return Outcome::running();
  return fail(context, context.axis.who() + ": no usable " +
                           context.axis.profile().feedbackObjects() + " within " + seconds(waited) +
                           "; check the " + context.axis.device().terms().input +
                           "s, or recover the axis, which boots the drive");
}

/// A drive that holds in quick stop active and takes no parameters there goes on with those that it
/// was enabled with; its target follows the actual position meanwhile.
bool EnableStep::resumes(const AxisCore& axis) const {
  const DriveProfile& profile = axis.profile();
  return axis.state().state == State::quick_stop_active && !profile.quick_stop_holds.empty() &&
         profile.mode_change.needs_disabling && axis.config().quick_stop_holds &&
         &axis.mode().channel() == channel_ && inMode(axis);
}

Outcome EnableStep::awaitRest(const Context& context) {
  AxisCore& axis = context.axis;
  if (!axis.state().feedback_valid) {
    enter(Phase::feedback, context);
    return Outcome::running();
  }
  if (axis.feedback().atStandstill() && !axis.feedback().heardLately(context.now))
    return Outcome::running();
  if (axis.feedback().atStandstill()) {
    enter(resumes(axis) ? Phase::transitions : Phase::writing, context);
    return Outcome::running();
  }
  const bool off = axis.powerOff();
  // What brakes it is neither cut short nor missed.
  if (!off && axis.goal() != Goal::quick_stop) axis.setGoal(Goal::quick_stop);
  const Duration waited = context.now - since_;
  if (waited <= kComeToRest) return Outcome::running();
  const std::string why = axis.who() + ": is not switched on, for it still moves after " +
                          seconds(waited) + " (velocity " + number(axis.state().velocity) + ")";
  return Outcome::failed(off ? why + " and nothing of the drive brakes it; bring it to rest"
                             : why + ", quick stop is commanded; " + report(axis));
}

Outcome EnableStep::awaitLimits(const Context& context) {
  AxisCore& axis = context.axis;
  if (!axis.limits().settled()) return Outcome::running();
  const std::string problem = axis.limits().problem();
  if (!problem.empty()) {
    return fail(context, axis.who() +
                             ": is not enabled, as the drive holds position limits of another "
                             "zero, to which it would move: " +
                             problem);
  }
  enter(Phase::mode, context);
  return Outcome::running();
}

/// Time has passed: it may have been moved, and its limits may be about to change.
Outcome EnableStep::awaitMode(const Context& context) {
  AxisCore& axis = context.axis;
  const Outcome outcome = mode_.advance(context);
  if (!outcome.isDone()) return outcome;
  if (!axis.state().feedback_valid || !axis.feedback().seenToStand(context.now)) {
    enter(Phase::standing, context);
    context.show("waiting for standstill", "the axis to stand, before the power comes");
    return Outcome::running();
  }
  if (!axis.limits().settled()) {
    enter(Phase::limits, context);
    context.show("writing position limits", "the drive to take the joint's limits");
    return Outcome::running();
  }
  enter(Phase::transitions, context);
  return climb(context);
}

Outcome EnableStep::climb(const Context& context) {
  AxisCore& axis = context.axis;
  if (axis.inOperation() && axis.feedback().heardLately(context.now)) {
    enter(Phase::shown, context);
    return awaitShown(context);
  }
  const State state = axis.state().state;
  if (state != last_) {
    last_ = state;
    since_ = context.now;
    context.show("switching on", std::string("the drive to leave ") + toString(state));
  }
  // From quick stop active by transition 16 where the drive holds there; by 12 where it does not,
  // or does not answer to 16.
  const DriveProfile::Timing& timing = axis.profile().timing;
  const bool stopped = state == State::quick_stop_active;
  const bool by_disabling = stopped && (axis.profile().quick_stop_holds.empty() ||
                                        context.now - since_ > timing.transition(16) / 2);
  Goal goal = by_disabling ? Goal::disabled : Goal::enabled;
  // A quick stop under way is neither cut short nor left in motion.
  if (stopped && axis.generator().moving()) goal = Goal::quick_stop;
  if (axis.goal() != goal) axis.setGoal(goal);
  const Duration limit =
      stopped ? (timing.transition(16) + timing.transition(12)) / 2 + axis.control().powerOffTime()
              : timing.transition(nextCommand(state, goal).transition);
  if (context.now - since_ <= limit) return Outcome::running();
  return fail(context, axis.who() + ": enabling timed out: the drive has been in " +
                           toString(state) + " for " + seconds(context.now - since_) + "; " +
                           report(axis));
}

/// Until the mode is shown the targets are neutral, and the axis takes no command.
Outcome EnableStep::awaitShown(const Context& context) {
  AxisCore& axis = context.axis;
  const Outcome outcome = shown_.advance(context);
  if (!outcome.isDone() && !axis.inOperation()) {
    enter(Phase::transitions, context);  // which says why it is not enabled
    return climb(context);
  }
  if (outcome.isFailed()) axis.setGoal(Goal::disabled);
  if (!outcome.isDone()) return outcome;
  enter(Phase::brake, context);
  context.show("releasing the brake",
               seconds(axis.control().brakeRelease()) + " to pass (profile, brake_release)");
  return Outcome::running();
}

/// Its power may have gone since it was seen in operation; then its state says so, or it is lost.
Outcome EnableStep::awaitBrake(const Context& context) {
  const AxisCore& axis = context.axis;
  const bool enabled = axis.inOperation() && axis.feedback().heardLately(context.now);
  return enabled && axis.brakeReleased() ? Outcome::done() : Outcome::running();
}

/// The drive may say itself why it is not ready.
Outcome EnableStep::fail(const Context& context, std::string why) {
  AxisCore& axis = context.axis;
  axis.setGoal(Goal::disabled);
  const ObjectSpec* reason = axis.profile().find(axis.profile().not_ready_reason);
  if (reason == nullptr || !axis.deviceReady()) return Outcome::failed(std::move(why));
  why_ = std::move(why);
  reason_ = axis.device().objects().upload(reason->id, reason->name);
  return Outcome::running();
}

Outcome EnableStep::explain(const Context& context) {
  if (!reason_->done()) return Outcome::running();
  const ObjectSpec& object = *context.axis.profile().find(context.axis.profile().not_ready_reason);
  const bool told = reason_->ok() && !reason_->data().empty() && reason_->data().size() <= 8;
  const auto number =
      static_cast<std::int64_t>(told ? fieldbus::toUnsigned(reason_->data()) : std::uint64_t{0});
  if (number == 0) return Outcome::failed(why_);
  const std::string word = textOf(object.words, number);
  return Outcome::failed(why_ + "; " + object.name + " (" + fieldbus::toString(object.id) +
                         ") is " + std::to_string(number) + (word.empty() ? "" : ": " + word));
}

}  // namespace cia402::drive
