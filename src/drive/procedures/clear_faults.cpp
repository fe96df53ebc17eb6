// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/fault_reset.h"

namespace cia402::drive {
namespace {

/// Clears a fault and leaves the axis disabled.
class ClearFaults : public Procedure {
 public:
  Outcome advance(const Context& context) override {
    AxisCore& axis = context.axis;
    if (!begun_) {
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

  bool begun_ = false;
  FaultResetStep reset_;
};

}  // namespace

Result<std::unique_ptr<Procedure>> makeClearFaults(AxisCore& axis) {
  const std::string refusal = deviceRefusal(axis, "clear faults");
  if (!refusal.empty()) return Error{refusal};
  return std::unique_ptr<Procedure>(std::make_unique<ClearFaults>());
}

}  // namespace cia402::drive
