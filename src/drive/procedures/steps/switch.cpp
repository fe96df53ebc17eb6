// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/switch.h"

#include "drive/procedures/limits.h"
#include "drive/sentence.h"

namespace cia402::drive {

Outcome ReadyToSwitchStep::advance(const Context& context) {
  AxisCore& axis = context.axis;
  if (!begun_) started_ = context.now;
  begun_ = true;
  ready_ = ready_ || axis.powerOff();
  if (ready_) return Outcome::done();
  if (!standing_) {
    if (axis.stops().endsGoal()) {
      context.show("awaiting the end of a goal", "the drive to take the place where it stands");
      started_ = context.now;
      return Outcome::running();
    }
    if (context.now < started_) return Outcome::running();
    const Outcome standing = awaitStandstill(context, started_, "switching the mode");
    if (!standing.isDone()) return standing;
    // Without power, or in another mode, nothing would hold it that is let go just now.
    const auto back = withdrawn_ ? std::nullopt : axis.generator().withdraw();
    withdrawn_ = true;
    if (back) {
      started_ = context.now + *back;
      context.show("taking back a target that was not reached", "the drive to be done with it");
      return Outcome::running();
    }
    standing_ = true;
    axis.limits().renew();
    context.show("writing position limits", "the drive to take the joint's limits");
  }
  if (!axis.limits().settled()) return Outcome::running();
  const std::string problem = axis.limits().problem();
  if (!problem.empty()) {
    return Outcome::failed(axis.who() +
                           ": the mode is not switched, as the axis is beyond the position limits "
                           "that the drive keeps, to which it would move; lead it back by a "
                           "velocity or an effort, or disable it: " +
                           problem);
  }
  ready_ = true;
  return Outcome::done();
}

Outcome SwitchStep::advance(const Context& context) {
  switch (phase_) {
    case Phase::begin:
      return begin(context);
    case Phase::disabling:
      return awaitDisabled(context);
    case Phase::enabling:
      return enabling_.advance(context);
    case Phase::detour: {
      const Outcome outcome = between_->advance(context);
      if (!outcome.isDone()) return outcome;
      phase_ = Phase::switching;
      return Outcome::running();
    }
    case Phase::switching:
      return mode_.advance(context);
  }
  return Outcome::running();
}

Outcome SwitchStep::begin(const Context& context) {
  AxisCore& axis = context.axis;
  const ModeChange& rules = axis.profile().mode_change;
  const ModeChange::Detour* detour = rules.detour(axis.mode().spec().name, channel_->spec->name);
  const ModeChannel* between =
      detour == nullptr ? nullptr : axis.objects().channel(detour->through);
  const bool by_disabling = rules.needs_disabling || (detour != nullptr && between == nullptr);
  if (!axis.inOperation() || (!by_disabling && between == nullptr)) {
    phase_ = Phase::switching;
    return Outcome::running();
  }
  if (&axis.mode().channel() == channel_ && inMode(axis)) {
    return Outcome::done();
  }
  if (between != nullptr) {
    between_.emplace(*between);
    phase_ = Phase::detour;
    return Outcome::running();
  }
  phase_ = Phase::disabling;
  since_ = context.now;
  was_disabled_ = true;
  axis.setGoal(Goal::disabled);
  context.show("disabling, as the drive does not take that mode while enabled",
               "the drive to show switch on disabled");
  return Outcome::running();
}

Outcome SwitchStep::awaitDisabled(const Context& context) {
  AxisCore& axis = context.axis;
  if (axis.state().state == State::switch_on_disabled) {
    phase_ = Phase::enabling;
    return Outcome::running();
  }
  if (axis.faulted()) return Outcome::failed(axis.faults().text());
  if (context.now - since_ <= disablingAtOnce(axis)) return Outcome::running();
  return Outcome::failed(axis.who() + ": mode " + channel_->spec->name +
                         " was not taken: the drive must be disabled for it and was not within " +
                         seconds(context.now - since_) + "; " + report(axis));
}

}  // namespace cia402::drive
