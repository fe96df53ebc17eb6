// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include "common/text.h"
#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/switch.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// Switches the mode of operation, disabled or enabled at standstill. Where the axis asks for it
/// one that moves is halted before by what its mode has for that, and released from the halt in the
/// new mode; before, where the halt is in the way of the mode.
class SetMode : public Procedure {
 public:
  SetMode(const ModeChannel& mode, const DriveProfile& profile)
      : mode_(&mode), step_(mode, profile) {}

  Outcome advance(const Context& context) override {
    if (phase_ == Phase::begin) begin(context);
    switch (phase_) {
      case Phase::begin:
        break;
      case Phase::stopping:
        return stop(context);
      case Phase::releasing:
        return enable(context);
      case Phase::switching:
        return change(context);
      case Phase::enabling: {
        const Outcome outcome = enable(context);
        return outcome.isDone() ? Outcome::done(text(context)) : outcome;
      }
    }
    return Outcome::running();
  }

 private:
  enum class Phase { begin, stopping, releasing, switching, enabling };

  void begin(const Context& context) {
    AxisCore& axis = context.axis;
    started_ = context.now;
    phase_ = Phase::switching;
    if (!axis.config().set_mode_stops || axis.powerOff() || !axis.generator().moving()) return;
    goes_on_ = axis.inOperation() && !axis.state().halted;
    phase_ = Phase::stopping;
  }

  /// @return done once `make`, made when it is due, is
  template <typename Make>
  Outcome run(const Context& context, Make make) {
    if (!under_way_) {
      auto made = make(context.axis);
      if (!made) return Outcome::failed(made.error().message);
      under_way_ = std::move(made).value();
    }
    Outcome outcome = under_way_->step(context);
    if (outcome.isDone()) under_way_.reset();
    return outcome;
  }

  Outcome stop(const Context& context) {
    const Outcome outcome = run(context, makeHalt);
    if (!outcome.isDone()) return outcome;
    const AxisCore& axis = context.axis;
    stopped_ = true;
    const bool in_the_way = axis.state().halted && !axis.profile().mode_change.while_halted;
    phase_ = goes_on_ && in_the_way ? Phase::releasing : Phase::switching;
    return Outcome::running();
  }

  Outcome enable(const Context& context) {
    const Outcome outcome = run(context, makeEnable);
    if (!outcome.isDone()) return outcome;
    if (phase_ == Phase::enabling) return outcome;
    phase_ = Phase::switching;
    return Outcome::running();
  }

  Outcome change(const Context& context) {
    const Outcome ready = waiting_.advance(context);
    if (!ready.isDone()) return ready;
    const AxisCore& axis = context.axis;
    Outcome outcome = step_.advance(context);
    if (outcome.isFailed() && goes_on_ && axis.state().halted) {
      outcome.message += "; it was stopped for that and stays halted, enable releases the halt";
    }
    if (!outcome.isDone()) return outcome;
    if (!goes_on_ || (axis.inOperation() && !axis.state().halted)) {
      return Outcome::done(text(context));
    }
    phase_ = Phase::enabling;
    return Outcome::running();
  }

  std::string text(const Context& context) const {
    return jointName(context.axis.config()) + ": mode " + mode_->spec->name + " after " +
           seconds(context.now - started_) + (stopped_ ? ", it was stopped for that" : "") +
           (step_.wasDisabled() ? ", disabled meanwhile as the drive demands" : "");
  }

  const ModeChannel* mode_;
  SwitchStep step_;
  ReadyToSwitchStep waiting_;
  Phase phase_ = Phase::begin;
  std::unique_ptr<Procedure> under_way_;  ///< halt or enable
  bool stopped_ = false;
  bool goes_on_ = false;  ///< it was taking commands before it was stopped
  Time started_{};
};

std::string knownModes(const AxisCore& axis) {
  std::string names;
  for (const ModeChannel& channel : axis.objects().modes) {
    if (channel.spec->kind == ControlKind::homing || !axis.mode().refusal(channel).empty()) {
      continue;
    }
    append(names, channel.spec->name, ", ");
  }
  return names;
}

}  // namespace

Result<std::unique_ptr<Procedure>> makeSetMode(AxisCore& axis, const std::string& mode) {
  const std::string name = canonicalModeName(mode);
  const ModeChannel* channel = axis.objects().channel(name);
  if (channel == nullptr) {
    return Error{axis.who() + ": the drive family " + axis.profile().name + " has no mode \"" +
                 mode + "\"; it has " + knownModes(axis)};
  }
  if (channel->spec->kind == ControlKind::homing) {
    return Error{axis.who() + ": " + name + " is not entered by set_mode; call home"};
  }
  const std::string unusable = axis.mode().refusal(*channel);
  if (!unusable.empty()) {
    return Error{axis.who() + ": mode " + name + " cannot be used: " + unusable};
  }
  if (axis.state().halted && !axis.profile().mode_change.while_halted) {
    return Error{axis.who() + ": mode " + name +
                 " is refused, for the axis is halted and the drive takes no mode then; enable "
                 "releases the halt"};
  }
  const std::string refusal = deviceRefusal(axis, "set the mode");
  if (!refusal.empty()) return Error{refusal};
  if (!axis.state().feedback_valid) {
    return Error{axis.who() + ": cannot set the mode: no fresh statusword and position"};
  }
  const bool moves = !axis.powerOff() && axis.generator().moving();
  if (moves && !axis.config().set_mode_stops) {
    return Error{axis.who() + ": mode " + name + " is refused in motion (velocity " +
                 number(axis.state().velocity) +
                 "); stop the axis first (set_mode_in_motion: stop does it)"};
  }
  return std::unique_ptr<Procedure>(std::make_unique<SetMode>(*channel, axis.profile()));
}

}  // namespace cia402::drive
