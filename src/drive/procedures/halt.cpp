// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "drive/procedures/limits.h"
#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/stop.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// Stops an enabled axis by what its mode has for it, and keeps it enabled where that is possible:
/// set-points ramped to rest, controlword bit 8, or the quick stop. The halt lasts until `enable`
/// releases it. An axis that is being stopped already is waited for.
class Halt : public Procedure {
 public:
  Outcome advance(const Context& context) override {
    AxisCore& axis = context.axis;
    if (!begun_) return begin(context);
    if (quick_stop_) return awaitQuickStop(context);
    if (axis.generator().sent().atRest() && axis.feedback().seenToStand(context.now)) {
      return Outcome::done(jointName(axis.config()) + ": halted at " + place(axis) +
                           "; enable releases the halt");
    }
    if (context.now < until_) return Outcome::running();
    const std::string velocity = number(axis.state().velocity);
    axis.setGoal(Goal::quick_stop);
    return Outcome::failed(axis.who() + ": halt did not bring the axis to standstill within " +
                           seconds(context.now - started_) + " (velocity " + velocity +
                           "); quick stop is commanded. " + report(axis));
  }

 private:
  Outcome begin(const Context& context) {
    AxisCore& axis = context.axis;
    begun_ = true;
    started_ = context.now;
    until_ = context.now + stopTime(axis.config(), axis.state().velocity);
    mode_ = axis.mode().spec().name;
    if (axis.inOperation()) {
      axis.stops().halt(context.now);
      if (axis.inOperation()) {
        context.show("halting", "standstill");
        return Outcome::running();
      }
      was_enabled_ = true;
    } else if (axis.goal() == Goal::enabled) {  // the procedure before was switching it on
      axis.setGoal(Goal::disabled);
      return Outcome::remarked(jointName(axis.config()) +
                               ": was being enabled, is switched off again instead");
    } else if (axis.powerOff()) {
      was_off_ = true;
      if (!axis.feedback().mayMove()) return nothingToHalt(axis);
    }
    quick_stop_.emplace();
    return quick_stop_->advance(context);
  }

  Outcome awaitQuickStop(const Context& context) {
    AxisCore& axis = context.axis;
    const Outcome outcome = quick_stop_->advance(context);
    if (!outcome.isDone()) return outcome;
    if (was_off_ && axis.powerOff()) return nothingToHalt(axis);
    std::string text =
        jointName(axis.config()) + ": stands at " + place(axis) + ", stopped by a quick stop";
    if (was_enabled_) text += ", as mode " + mode_ + " has no other brake";
    return Outcome::done(text + (axis.powerOff() ? "; it is disabled, enable to go on"
                                                 : "; it holds its position, enable to go on"));
  }

  static Outcome nothingToHalt(const AxisCore& axis) {
    return Outcome::done(jointName(axis.config()) + ": is not enabled, so nothing is to be halted");
  }

  static std::string place(const AxisCore& axis) {
    if (!axis.state().feedback_valid) return "an unknown position";
    return length(axis.state().position, axis.config().geometry.prismatic());
  }

  bool begun_ = false, was_enabled_ = false, was_off_ = false;
  std::optional<QuickStopStep> quick_stop_;
  std::string mode_;
  Time started_{}, until_{};
};

}  // namespace

Result<std::unique_ptr<Procedure>> makeHalt(AxisCore& axis) {
  const std::string refusal = deviceRefusal(axis, "halt");
  if (!refusal.empty()) return Error{refusal};
  return std::unique_ptr<Procedure>(std::make_unique<Halt>());
}

}  // namespace cia402::drive
