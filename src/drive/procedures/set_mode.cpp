// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "common/text.h"
#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/switch.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// Switches the mode of operation, disabled or enabled at standstill.
class SetMode : public Procedure {
 public:
  SetMode(const ModeChannel& mode, const DriveProfile& profile)
      : mode_(&mode), step_(mode, profile) {}

  Outcome advance(const Context& context) override {
    AxisCore& axis = context.axis;
    if (!begun_) {
      begun_ = true;
      started_ = context.now;
    }
    const Outcome ready = waiting_.advance(context);
    if (!ready.isDone()) return ready;
    const Outcome outcome = step_.advance(context);
    if (!outcome.isDone()) return outcome;
    return Outcome::done(jointName(axis.config()) + ": mode " + mode_->spec->name + " after " +
                         seconds(context.now - started_) +
                         (step_.wasDisabled() ? ", disabled meanwhile as the drive demands" : ""));
  }

 private:
  const ModeChannel* mode_;
  SwitchStep step_;
  ReadyToSwitchStep waiting_;
  bool begun_ = false;
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
  if (!axis.powerOff() && axis.generator().moving()) {
    return Error{axis.who() + ": mode " + name + " is refused in motion (velocity " +
                 number(axis.state().velocity) + "); stop the axis first"};
  }
  return std::unique_ptr<Procedure>(std::make_unique<SetMode>(*channel, axis.profile()));
}

}  // namespace cia402::drive
