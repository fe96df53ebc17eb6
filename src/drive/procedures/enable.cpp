// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/switch.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// Enables the axis in its mode. An axis that is already enabled is released from a halt: the drive
/// is first given "stay here", so that it does not go on to where it was going.
class Enable : public Procedure {
 public:
  explicit Enable(AxisCore& axis)
      : enabling_(axis.mode().working(), axis.profile()),
        mode_(axis.mode().working(), axis.profile()) {}

  Outcome advance(const Context& context) override {
    if (!begun_) begin(context);
    return releasing_ ? release(context) : enable(context);
  }

 private:
  void begin(const Context& context) {
    begun_ = true;
    started_ = context.now;
    AxisCore& axis = context.axis;
    releasing_ = axis.inOperation();
    const bool homing = axis.mode().spec().kind == ControlKind::homing;
    const bool elsewhere =
        &axis.mode().channel() != &axis.mode().working();  // homing, or braked by a mode
    changing_mode_ = releasing_ && (elsewhere || !inMode(axis));
    blocked_ = changing_mode_ && axis.state().halted && !axis.profile().mode_change.while_halted;
    if (blocked_ && homing) {
      // The start bit of homing has been 0 since the halt: without the halt bit nothing begins.
      axis.stops().endHalt();
      blocked_ = false;
      released_ = true;
      frames_ = axis.control().frames();
    }
    if (!releasing_ || !axis.state().halted) return;
    replacing_ = !changing_mode_;
    axis.limits().renew();
    context.show("writing position limits", "the drive to hold the axis also beyond its limits");
  }

  Outcome release(const Context& context) {
    AxisCore& axis = context.axis;
    if (blocked_) return Outcome::failed(drive::obstacle(axis));
    if (!axis.limits().settled()) return Outcome::running();
    const std::string problem = axis.limits().problem();
    if (!problem.empty() && axis.state().halted) {
      return Outcome::failed(axis.who() +
                             ": the halt was not released, as the drive would move to its position "
                             "limits; disable and enable instead (" +
                             problem + ")");
    }
    if (std::exchange(replacing_, false)) {
      axis.stops().replaceHaltedTarget();
      frames_ = axis.generator().targetFrames();
      context.show("releasing the halt", "the drive to take its present position as set-point");
    }
    if (changing_mode_) {
      if (released_ && axis.control().frames() < frames_ + kSureFrames) return Outcome::running();
      const Outcome ready = waiting_.advance(context);
      if (!ready.isDone()) return ready;
      const Outcome outcome = mode_.advance(context);
      if (!outcome.isDone()) return outcome;
      changing_mode_ = false;
      mode_changed_ = true;
      frames_ = axis.generator().targetFrames();
    }
    if (!axis.feedback().heardLately(context.now)) {  // its power may have gone since
      context.show("asking whether it is enabled still", "fresh feedback");
      return Outcome::running();
    }
    if (!axis.inOperation()) {  // e.g. by the stop of an axis that was not heard
      return Outcome::failed(axis.who() +
                             ": was switched off while it was being enabled: enable it again. " +
                             report(axis));
    }
    if (released_) return released(axis);
    if (!axis.state().halted) {
      return Outcome::done(
          jointName(axis.config()) +
          (mode_changed_ ? ": is enabled and brought into mode " : ": is enabled already, mode ") +
          axis.mode().spec().name);
    }
    if (axis.generator().handingOver() || axis.generator().targetFrames() < frames_ + 2) {
      if (context.now - started_ <= 2 * axis.profile().timing.state_change) {
        return Outcome::running();
      }
      return Outcome::failed(axis.who() +
                             ": the halt was not released: the drive does not take a new set-point "
                             "while halted; disable and enable instead. " +
                             report(axis));
    }
    axis.stops().endHalt();
    return released(axis);
  }

  static Outcome released(const AxisCore& axis) {
    return Outcome::done(jointName(axis.config()) +
                         ": the halt is released, the axis holds its position");
  }

  Outcome enable(const Context& context) {
    const Outcome outcome = enabling_.advance(context);
    if (!outcome.isDone()) return outcome;
    AxisCore& axis = context.axis;
    return Outcome::done(jointName(axis.config()) + ": enabled in mode " + axis.mode().spec().name +
                         " after " + seconds(context.now - started_));
  }

  EnableStep enabling_;
  ReadyToSwitchStep waiting_;
  SwitchStep mode_;
  bool begun_ = false, releasing_ = false, released_ = false;
  bool changing_mode_ = false;  ///< inMode() is not true of the mode to be in
  bool mode_changed_ = false;
  bool replacing_ = false;  ///< where it was going is still to be taken back
  bool blocked_ = false;    ///< the halt is in the way of the mode
  std::uint64_t frames_ = 0;
  Time started_{};
};

}  // namespace

Result<std::unique_ptr<Procedure>> makeEnable(AxisCore& axis) {
  const std::string refusal = deviceRefusal(axis, "enable");
  if (!refusal.empty()) return Error{refusal};
  if (axis.faulted()) return Error{"cannot enable: " + axis.faults().text()};
  const ModeChannel& mode = axis.mode().working();
  const std::string unusable = axis.mode().refusal(mode);
  if (!unusable.empty()) {
    return Error{axis.who() + ": cannot enable in mode " + mode.spec->name + ": " + unusable};
  }
  return std::unique_ptr<Procedure>(std::make_unique<Enable>(axis));
}

}  // namespace cia402::drive
