// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/fault_reset.h"

#include "drive/procedures/limits.h"
#include "drive/profile/fault_text.h"
#include "drive/profile/named_write.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// What could not be tried as the device has other axes, too.
std::string pauseLeftOut(AxisCore& axis) {
  const std::string others = axis.basis().neighbours.refusal();
  if (others.empty() || axis.profile().fault_reset.pause == Duration::zero()) return {};
  return std::string("; ") + axis.device().terms().stop_and_start +
         ", after which it may be cleared, was left out: " + others + ", then recover " +
         jointName(axis.config()) + " alone";
}

}  // namespace

bool clearable(const AxisCore& axis) {
  return axis.faulted() || (axis.state().warning && axis.profile().warning_stops);
}

bool tellsState(const AxisCore& axis, Time now) {
  const AxisState& state = axis.state();
  return state.feedback_valid && state.state != State::unknown && axis.feedback().heardLately(now);
}

void FaultResetStep::enter(Phase phase, const Context& context) {
  phase_ = phase;
  since_ = context.now;
  frames_ = context.axis.control().frames();
}

Outcome FaultResetStep::fail(const Context& context, const std::string& why) const {
  context.axis.control().setFaultReset(false);
  return Outcome::failed(why);
}

Outcome FaultResetStep::cameBack(const Context& context) {
  if (tryAgain(context)) return Outcome::running();
  return fail(context, "the fault came back at once after the reset, its cause is still there: " +
                           context.axis.faults().text());
}

Outcome FaultResetStep::awaitNews(const Context& context) {
  const AxisCore& axis = context.axis;
  const Duration waited = context.now - since_;
  if (waited <= axis.profile().timing.state_change) return Outcome::running();
  return fail(
      context,
      axis.who() + ": nothing tells whether the fault reset has cleared its fault: " +
          (axis.state().feedback_valid ? axis.feedback().stateText() : axis.feedback().text()));
}

Outcome FaultResetStep::awaitReset(const Context& context) {
  AxisCore& axis = context.axis;
  const Duration waited = context.now - since_;
  if (axis.state().state == State::fault_reaction_active) return cameBack(context);
  if (clearable(axis)) {
    const bool last =
        tries_ >= axis.profile().fault_reset.tries && !mayWrite(context) && !mayPause(context);
    if (waited <= (last ? axis.profile().timing.transition(15) : kInterval) || tryAgain(context)) {
      return Outcome::running();
    }
    const std::string times = tries_ == 1 ? "" : " (" + std::to_string(tries_) + " tries)";
    return fail(context, "the fault reset (" + axis.profile().address(0x6040) + " bit 7)" + times +
                             " did not clear it within " + seconds(waited) + ": " +
                             axis.faults().text() + pauseLeftOut(axis) + "; " + report(axis));
  }
  if (!tellsState(axis, context.now)) return awaitNews(context);
  axis.control().setFaultReset(false);
  axis.faults().forgetFault();
  enter(Phase::low_again, context);
  context.show("fault reset", "controlword bit 7 to be sent low again");
  return Outcome::running();
}

/// Drives are known that need up to five (Schunk modules).
bool FaultResetStep::tryAgain(const Context& context) {
  AxisCore& axis = context.axis;
  const int most = axis.profile().fault_reset.tries;
  if (tries_ >= most && mayWrite(context)) {
    axis.control().setFaultReset(false);
    beginWrite(context);
    return true;
  }
  if (tries_ >= most && !mayPause(context)) return false;
  axis.control().setFaultReset(false);
  if (tries_++ >= most) {
    beginPause(context);
    return true;
  }
  const std::string number = "try " + std::to_string(tries_) + " of " + std::to_string(most);
  enter(Phase::reacting, context);
  context.show("resetting the fault again", number);
  return true;
}

bool FaultResetStep::mayWrite(const Context& context) const {
  return !written_ && !context.axis.profile().fault_reset.object.empty();
}

/// A drive that refuses it keeps its fault, as the edge after it shows.
void FaultResetStep::beginWrite(const Context& context) {
  AxisCore& axis = context.axis;
  written_ = true;
  const ObjectSpec* object = axis.profile().find(axis.profile().fault_reset.object);
  clearing_ =
      axis.device().objects().download(object->id, wireBytes(1, object->type), object->name);
  enter(Phase::clearing, context);
  context.show("clearing the fault by " + object->name,
               "the drive to take " + fieldbus::toString(object->id) + " = 1");
}

bool FaultResetStep::mayPause(const Context& context) const {
  return !paused_ && context.axis.profile().fault_reset.pause > Duration::zero() &&
         context.axis.basis().neighbours.refusal().empty();
}

void FaultResetStep::beginPause(const Context& context) {
  AxisCore& axis = context.axis;
  paused_ = true;
  axis.device().stopAndStart(axis.profile().fault_reset.pause, context.now);
  enter(Phase::paused, context);
  const fieldbus::Terms& terms = axis.device().terms();
  context.show(std::string("taking the ") + terms.device + " through " + terms.stop_and_start +
                   " for the fault reset",
               "the drive to be operational and to send its feedback again");
}

Duration FaultResetStep::pause(const DriveProfile& profile) {
  return profile.fault_reset.pause + fieldbus::Device::kStartPatience + profile.timing.state_change;
}

Outcome FaultResetStep::awaitPause(const Context& context) {
  const AxisCore& axis = context.axis;
  const bool heard = axis.state().feedback_valid && axis.feedback().heardLately(context.now);
  if (!context.axis.device().paused() && heard) {
    enter(Phase::reacting, context);
    return Outcome::running();
  }
  if (context.now - since_ <= pause(axis.profile())) return Outcome::running();
  return fail(context, axis.who() + ": after " + axis.device().terms().stop_and_start +
                           " no statusword came for " + seconds(context.now - since_) + ": " +
                           axis.feedback().text());
}

Outcome FaultResetStep::awaitReaction(const Context& context) {
  enter(Phase::reacting, context);
  context.show("waiting for the fault reaction to end", "the drive to show fault");
  return Outcome::running();
}

/// A drive that a warning stops, and that has power, may take its set-points up again once that is
/// cleared, at the speed that it has.
bool FaultResetStep::turns(const Context& context) {
  const AxisCore& axis = context.axis;
  return !axis.faulted() && !axis.powerOff() && axis.state().feedback_valid &&
         !axis.feedback().seenToStand(context.now);
}

Outcome FaultResetStep::begin(const Context& context) {
  const AxisCore& axis = context.axis;
  if (const std::string refusal = axis.faults().resetRefusal(context.now); !refusal.empty()) {
    return fail(context, refusal);
  }
  code_ = axis.state().error_code;
  enter(Phase::resting, context);
  if (turns(context)) {
    context.show("waiting for rest", "the drive to end the stop by which its warning holds it");
  }
  return awaitRest(context);
}

Outcome FaultResetStep::awaitRest(const Context& context) {
  AxisCore& axis = context.axis;
  if (turns(context) && context.now - since_ <= kComeToRest) return Outcome::running();
  axis.setGoal(Goal::disabled);
  if (!axis.profile().fault_reset.clears_history) return awaitReaction(context);
  clearing_ = axis.device().objects().download({0x1003, 0}, {0}, "error history");
  enter(Phase::clearing, context);
  context.show("clearing the error history", "the drive to take 1003:00 = 0");
  return Outcome::running();
}

Outcome FaultResetStep::advance(const Context& context) {
  AxisCore& axis = context.axis;
  const Duration waited = context.now - since_;
  const Duration limit = axis.profile().timing.state_change;
  const bool sent = axis.control().frames() >= frames_ + kSureFrames;
  switch (phase_) {
    case Phase::begin:
      return begin(context);
    case Phase::resting:
      return awaitRest(context);
    case Phase::clearing:  // a drive that refuses it may still take the reset
      return clearing_->done() ? awaitReaction(context) : Outcome::running();
    case Phase::reacting:
      if (axis.state().state == State::fault_reaction_active) {
        if (waited <= axis.profile().timing.transition(14)) return Outcome::running();
        return fail(context, axis.who() + ": the drive's fault reaction did not end within " +
                                 seconds(waited) + "; " + report(axis));
      }
      enter(Phase::low, context);
      context.show("resetting the fault", "controlword bit 7 to be sent low, then high");
      return Outcome::running();
    case Phase::low:
      if (axis.state().error_code != 0) code_ = axis.state().error_code;
      if (!sent && waited > limit) {
        return fail(context, axis.who() + ": no " + axis.device().terms().output +
                                 " has left for " + seconds(waited) + "; is the cycle running?");
      }
      if (!sent || context.now < axis.faults().nextReset()) return Outcome::running();
      axis.control().setFaultReset(true);
      axis.faults().noteReset(context.now + kInterval);
      enter(Phase::high, context);
      context.show("resetting the fault", "the drive to leave fault");
      return Outcome::running();
    case Phase::high:
      return awaitReset(context);
    case Phase::paused:
      return awaitPause(context);
    case Phase::low_again:
      if (!sent && waited <= limit) return Outcome::running();
      enter(Phase::watching, context);
      context.show("fault reset", "the fault to stay away");
      return Outcome::running();
    case Phase::watching:
      if (clearable(axis)) return cameBack(context);
      if (waited < kWatch) return Outcome::running();
      if (!tellsState(axis, context.now)) return awaitNews(context);
      return Outcome::done(code_ == 0 ? std::string("fault cleared")
                                      : "fault " + errorCodeText(axis.profile(), code_) +
                                            "; it is cleared");
  }
  return Outcome::running();
}

}  // namespace cia402::drive
