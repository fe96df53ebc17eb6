// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/limits.h"
#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/stop.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// Switches the power stage off. A moving axis is brought to rest by the quick stop ramp first, as
/// switching off alone lets most drives coast.
class Disable : public Procedure {
 public:
  Outcome advance(const Context& context) override {
    AxisCore& axis = context.axis;
    if (phase_ == Phase::begin) begin(context);
    if (phase_ == Phase::stopping) {
      const Outcome outcome = stop_.advance(context);
      if (outcome.isRunning()) return outcome;
      if (outcome.isFailed()) stop_problem_ = outcome.message;
      cut_ = outcome.isFailed();
      switchOff(context);
      return Outcome::running();
    }
    const bool faulted = axis.state().state == State::fault && axis.powerOff();
    if (faulted || axis.state().state == State::switch_on_disabled) {
      if (axis.feedback().mayMove()) return awaitRest(context);
      return finish(axis, faulted);
    }
    if (context.now - since_ <= disablingInTurn(axis)) return Outcome::running();
    return Outcome::failed(axis.who() + ": disabling timed out after " +
                           seconds(context.now - since_) + "; " + report(axis));
  }

 private:
  enum class Phase { begin, stopping, switching_off };

  void begin(const Context& context) {
    AxisCore& axis = context.axis;
    if (!axis.powerOff() &&
        !axis.feedback().seenToStand(context.now)) {  // an unknown state counts as powered
      phase_ = Phase::stopping;
    } else {
      switchOff(context);
    }
  }

  void switchOff(const Context& context) {
    phase_ = Phase::switching_off;
    since_ = context.now;
    cut_ ? context.axis.switchOff() : context.axis.setGoal(Goal::disabled);
    context.show("switching off", "the drive to show switch on disabled");
  }

  /// Without power nothing can be done for an axis that coasts, but to say when it stands.
  Outcome awaitRest(const Context& context) {
    AxisCore& axis = context.axis;
    if (!coasts_) {
      coasts_ = true;
      since_ = context.now;
      context.show("coasting", "the axis to come to rest; its power is off, nothing brakes it");
    }
    if (context.now - since_ <= kComeToRest) return Outcome::running();
    return Outcome::failed(axis.who() + ": is disabled, but after " +
                           seconds(context.now - since_) + " " + axis.feedback().coastingText());
  }

  Outcome finish(AxisCore& axis, bool faulted) const {
    const std::string plain = jointName(axis.config()) + ": disabled";
    std::string text = plain;
    if (faulted) text += "; " + axis.faults().text();
    if (!stop_problem_.empty()) text += ", but " + stop_problem_;
    return text == plain ? Outcome::done(text) : Outcome::remarked(text);
  }

  Phase phase_ = Phase::begin;
  QuickStopStep stop_;
  std::string stop_problem_;
  bool coasts_ = false;
  bool cut_ = false;  ///< the quick stop did not do it: disable voltage, whatever the drive shows
  Time since_{};
};

}  // namespace

Result<std::unique_ptr<Procedure>> makeDisable(AxisCore& axis) {
  const std::string refusal = deviceRefusal(axis, "disable");
  if (!refusal.empty()) return Error{refusal + "; whether its power stage is off is unknown"};
  return std::unique_ptr<Procedure>(std::make_unique<Disable>());
}

}  // namespace cia402::drive
