// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/mode_shown.h"

#include "drive/sentence.h"

namespace cia402::drive {

Outcome ModeShownStep::advance(const Context& context) {
  AxisCore& axis = context.axis;
  const ModeChange& rules = axis.profile().mode_change;
  const int wanted = mode_->spec->value;
  switch (phase_) {
    case Phase::begin:
      since_ = context.now;
      if (axis.feedback().shownMode() == wanted) return Outcome::done();
      if (rules.again == ModeChange::Again::through_zero) {
        command(context, Phase::zero, 0);
      } else if (rules.again == ModeChange::Again::same && beginDetour(axis)) {
        return Outcome::running();
      } else if (rules.again == ModeChange::Again::same) {
        command(context, Phase::again, wanted);
      } else {
        phase_ = Phase::waiting;
      }
      context.show("waiting for the mode", axis.profile().address(0x6061) + " to show " +
                                               std::to_string(wanted) + " (" + mode_->spec->name +
                                               ")");
      return Outcome::running();
    case Phase::zero:
      if (sent(context)) command(context, Phase::again, wanted);
      return await(context);
    case Phase::between: {
      const Outcome outcome = between_->advance(context);
      if (!outcome.isDone()) return outcome;
      phase_ = Phase::detour;
      return Outcome::running();
    }
    case Phase::detour:
      return last_->advance(context);
    case Phase::again:
      if (sent(context)) phase_ = Phase::waiting;
      return await(context);
    case Phase::waiting:
      return await(context);
  }
  return Outcome::running();
}

/// What it shows is the mode that it was in before it was disabled: the one that it leaves.
bool ModeShownStep::beginDetour(const AxisCore& axis) {
  if (!axis.feedback().shownMode()) return false;
  const ModeChannel* shown = axis.objects().channelOfValue(*axis.feedback().shownMode());
  if (shown == nullptr) return false;
  const ModeChange::Detour* detour =
      axis.profile().mode_change.detour(shown->spec->name, mode_->spec->name);
  const ModeChannel* between =
      detour == nullptr ? nullptr : axis.objects().channel(detour->through);
  if (between == nullptr) return false;
  between_.emplace(*between, mode_);
  last_.emplace(*mode_, mode_);
  phase_ = Phase::between;
  return true;
}

void ModeShownStep::command(const Context& context, Phase phase, int value) {
  AxisCore& axis = context.axis;
  phase_ = phase;
  frames_ = axis.control().frames();
  const OutputObject& object = axis.objects().mode;
  if (axis.mode().travels()) {
    const bool is_mode = value == mode_->spec->value;
    axis.mode().overrideValue(is_mode ? std::optional<int>() : std::optional<int>(value));
  } else if (object.spec != nullptr) {
    ticket_ = axis.device().objects().download(
        object.spec->id, wireBytes(static_cast<std::uint64_t>(value), object.spec->type),
        object.spec->name);
  }
}

bool ModeShownStep::sent(const Context& context) const {
  if (ticket_ != nullptr) return ticket_->done();
  return context.axis.control().frames() >= frames_ + kSureFrames;
}

Outcome ModeShownStep::await(const Context& context) {
  AxisCore& axis = context.axis;
  const bool shown = phase_ == Phase::waiting && axis.feedback().shownMode() == mode_->spec->value;
  if (shown) return Outcome::done();
  if (context.now - since_ <= axis.profile().timing.mode_change) return Outcome::running();
  const std::string shows = axis.feedback().shownMode()
                                ? std::to_string(*axis.feedback().shownMode())
                                : std::string("nothing");
  return Outcome::failed(
      axis.who() + ": the drive is in operation, but not in mode " + mode_->spec->name + ": " +
      axis.profile().address(0x6061) + " shows " + shows + " instead of " +
      std::to_string(mode_->spec->value) + " " + seconds(context.now - since_) +
      " after it was enabled; it is disabled. Look in its manual when it takes a "
      "mode (mode_change of the profile); " +
      report(axis));
}

}  // namespace cia402::drive
