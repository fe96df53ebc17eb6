// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "step_switch.h"

#include "sentence.h"

namespace cia402::drive {

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
  const ModeChange::Detour* detour = rules.detour(axis.mode().spec->name, channel_->spec->name);
  const ModeChannel* between =
      detour == nullptr ? nullptr : axis.objects().channel(detour->through);
  const bool by_disabling = rules.needs_disabling || (detour != nullptr && between == nullptr);
  if (!axis.inOperation() || (!by_disabling && between == nullptr)) {
    phase_ = Phase::switching;
    return Outcome::running();
  }
  if (&axis.mode() == channel_ && axis.shownMode() == channel_->spec->value) {
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
  if (axis.faulted()) return Outcome::failed(axis.faultText());
  if (context.now - since_ <= axis.profile().timing.state_change) return Outcome::running();
  return Outcome::failed(axis.who() + ": mode " + channel_->spec->name +
                         " was not taken: the drive must be disabled for it and was not within " +
                         seconds(context.now - since_) + "; " + axis.report());
}

}  // namespace cia402::drive
