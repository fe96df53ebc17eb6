// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/fault_reset.h"

namespace cia402::drive {
namespace {

/// One edge of controlword bit 7 takes a warning back that stops nothing: the axis goes on.
class WarningResetStep {
 public:
  Outcome advance(const Context& context) {
    AxisCore& axis = context.axis;
    const bool sent = axis.control().frames() >= frames_ + kSureFrames;
    switch (phase_) {
      case Phase::begin:
        text_ = axis.faults().text();
        axis.control().setFaultReset(false);
        enter(Phase::low, context);
        context.show("taking the warning back", "controlword bit 7 to be sent low, high, low");
        return Outcome::running();
      case Phase::low:
        if (!sent) break;
        axis.control().setFaultReset(true);
        enter(Phase::high, context);
        return Outcome::running();
      case Phase::high:
        if (!sent) break;
        axis.control().setFaultReset(false);
        enter(Phase::looking, context);
        return Outcome::running();
      case Phase::looking:
        if (sent && !axis.state().warning) {
          return Outcome::done(jointName(axis.config()) + ": the warning is taken back: " + text_);
        }
        break;
    }
    if (context.now - since_ <= axis.profile().timing.state_change) return Outcome::running();
    axis.control().setFaultReset(false);
    return Outcome::failed(
        axis.who() + ": the warning stays, its cause is still there: " + axis.faults().text());
  }

 private:
  enum class Phase { begin, low, high, looking };
  void enter(Phase phase, const Context& context) {
    phase_ = phase;
    since_ = context.now;
    frames_ = context.axis.control().frames();
  }

  Phase phase_ = Phase::begin;
  Time since_{};
  std::uint64_t frames_ = 0;
  std::string text_;
};

/// Clears a fault and leaves the axis disabled, or takes a warning back.
class ClearFaults : public Procedure {
 public:
  explicit ClearFaults(bool of_warning) : of_warning_(of_warning) {}
  bool letsMotionGoOn() const override { return of_warning_; }
  Outcome advance(const Context& context) override {
    AxisCore& axis = context.axis;
    if (!begun_) {
      if (of_warning_ && !axis.faulted()) return warning_.advance(context);
      if (!clearable(axis)) return findNothing(context);
      begun_ = true;
    }
    Outcome outcome = reset_.advance(context);
    if (outcome.isDone()) {
      outcome.message =
          jointName(axis.config()) + ": " + outcome.message + "; the axis is disabled";
    }
    return outcome;
  }

 private:
  static Outcome findNothing(const Context& context) {
    AxisCore& axis = context.axis;
    if (tellsState(axis, context.now)) return nothingToClear(axis);
    const Duration waited = context.now - context.status.started;
    context.show("waiting for the statusword", "the drive to tell whether it has a fault");
    if (waited <= axis.profile().timing.state_change) return Outcome::running();
    return Outcome::failed(
        axis.who() + ": nothing tells whether it has a fault: " +
        (axis.state().feedback_valid ? axis.feedback().stateText() : axis.feedback().text()));
  }

  static Outcome nothingToClear(AxisCore& axis) {
    const std::uint16_t code = axis.faults().pendingEmergency();
    if (code == 0) return Outcome::done(jointName(axis.config()) + ": no fault, nothing to clear");
    const std::string text = axis.faults().codeText(code);
    axis.faults().forgetFault();
    return Outcome::done(jointName(axis.config()) +
                         ": no fault; the emergency that the drive has not "
                         "ended is forgotten: " +
                         text);
  }

  bool of_warning_;  ///< it began without a fault
  bool begun_ = false;
  FaultResetStep reset_;
  WarningResetStep warning_;
};

}  // namespace

Result<std::unique_ptr<Procedure>> makeClearFaults(AxisCore& axis) {
  const std::string refusal = deviceRefusal(axis, "clear faults");
  if (!refusal.empty()) return Error{refusal};
  const bool warned = !axis.faulted() && axis.state().feedback_valid && axis.state().warning &&
                      !axis.profile().warning_stops;
  return std::unique_ptr<Procedure>(std::make_unique<ClearFaults>(warned));
}

}  // namespace cia402::drive
