// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/mode.h"

#include "drive/sentence.h"

namespace cia402::drive {
namespace {
constexpr Duration kQuestionInterval{std::chrono::milliseconds(20)};

std::string modeText(int value, const AxisCore& axis) {
  const ModeChannel* channel = axis.objects().channelOfValue(value);
  return std::to_string(value) + " (" +
         (channel != nullptr ? channel->spec->name : std::string("no mode of the profile")) + ")";
}
}  // namespace

Outcome ModeStep::advance(const Context& context) {
  AxisCore& axis = context.axis;
  switch (phase_) {
    case Phase::writing: {
      const Outcome outcome = writes_.advance(context);
      if (writes_.wrote()) axis.mode().setPrepared(false);
      if (!outcome.isDone()) return outcome;
      axis.generator().preset(*mode_);
      // What brakes at rest would be in the way of the mode; it ends with the mode anyway.
      if (!axis.profile().mode_change.while_halted) axis.control().endBraking();
      frames_ = mode_->target.mapped() ? axis.device().image().sent(mode_->target.slot)
                                       : axis.control().frames();
      controlword_frames_ = axis.control().frames();
      started_ = context.now;
      phase_ = Phase::presetting;
      context.show("setting the target to the actual value",
                   std::string("its ") + axis.device().terms().output + " to be sent");
      return Outcome::running();
    }
    case Phase::presetting: {
      const std::uint64_t sent = mode_->target.mapped()
                                     ? axis.device().image().sent(mode_->target.slot)
                                     : axis.control().frames();
      const bool unbraked = axis.control().frames() >= controlword_frames_ + kSureFrames;
      if (sent >= frames_ + kSureFrames && unbraked) {
        select(context);
      } else if (context.now - started_ > axis.profile().timing.mode_change) {
        return Outcome::failed(axis.who() + ": no " + axis.device().terms().output +
                               " has left for " + seconds(context.now - started_) +
                               "; is the cycle running?");
      }
      return Outcome::running();
    }
    case Phase::sending:
      if (!command_->done()) return Outcome::running();
      if (!command_->ok()) return fail(context, command_->message());
      phase_ = Phase::waiting;
      return Outcome::running();
    case Phase::waiting:
      return await(context);
  }
  return Outcome::running();
}

void ModeStep::enter(AxisCore& axis, const ModeChannel& mode) const {
  axis.selectMode(mode);
  if (bound_for_ != nullptr) axis.mode().bindFor(*bound_for_);
}

void ModeStep::select(const Context& context) {
  AxisCore& axis = context.axis;
  before_ = &axis.mode().channel();
  enter(axis, *mode_);
  for (const WriteStep::Mapped& mapped : writes_.mapped())
    axis.mode().hold(mapped.slot, mapped.raw);
  started_ = context.now;
  controlword_frames_ = axis.generator().targetFrames();
  const OutputObject& object = axis.objects().mode;
  if (axis.mode().travels() || object.spec == nullptr) {
    phase_ = Phase::waiting;
  } else {
    command_ = axis.device().objects().download(
        object.spec->id,
        wireBytes(static_cast<std::uint64_t>(mode_->spec->value), object.spec->type),
        object.spec->name);
    phase_ = Phase::sending;
  }
  context.show("switching the mode", context.axis.profile().address(0x6061) + " to show " +
                                         modeText(mode_->spec->value, axis));
}

Outcome ModeStep::await(const Context& context) {
  AxisCore& axis = context.axis;
  askForDisplay(context);
  // Some show it in operation enabled only; what is shown counts before the axis takes a command.
  const bool later = axis.profile().mode_change.shown_when_enabled && !axis.inOperation();
  const bool shown = later || axis.feedback().shownMode() == mode_->spec->value;
  if (shown && axis.generator().targetFrames() >= controlword_frames_ + kSureFrames) {
    axis.mode().setPrepared(true);
    return Outcome::done();
  }
  if (context.now - started_ <= axis.profile().timing.mode_change) return Outcome::running();
  const std::string shows =
      axis.feedback().shownMode() ? modeText(*axis.feedback().shownMode(), axis) : "nothing";
  return fail(context, axis.profile().address(0x6061) + " mode display shows " + shows + " " +
                           seconds(context.now - started_) + " after " +
                           axis.profile().address(0x6060) + " was set to " +
                           modeText(mode_->spec->value, axis) + "; " + report(axis));
}

void ModeStep::askForDisplay(const Context& context) {
  const Signal& object = context.axis.objects().signals[SignalId::mode_display];
  if (object.spec == nullptr || object.mapped()) return;
  if (display_ && display_->done()) {
    if (display_->ok() && display_->data().size() <= 8) {
      context.axis.feedback().putShownMode(fieldbus::toUnsigned(display_->data()), context.now);
    }
    display_.reset();
    next_question_ = context.now + kQuestionInterval;
  }
  if (!display_ && context.now >= next_question_) {
    display_ = context.axis.device().objects().upload(object.spec->id, object.spec->name);
  }
}

Outcome ModeStep::fail(const Context& context, const std::string& why) {
  AxisCore& axis = context.axis;
  if (before_ != nullptr && before_ != mode_) {
    enter(axis, *before_);
    const OutputObject& object = axis.objects().mode;
    if (!axis.mode().travels() && object.spec != nullptr) {
      axis.device().objects().download(
          object.spec->id,
          wireBytes(static_cast<std::uint64_t>(before_->spec->value), object.spec->type),
          object.spec->name);
    }
  }
  return Outcome::failed(axis.who() + ": mode " + mode_->spec->name + " was not taken: " + why);
}

}  // namespace cia402::drive
