// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/stop.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// Quick stop, then what the drive does after it: it switches itself off (transition 12), or holds
/// in quick stop active where 605Ah has one of the profile's quick_stop_holds values.
class QuickStop : public Procedure {
 public:
  Outcome advance(const Context& context) override {
    if (!stopped_) {
      const Outcome outcome = stop_.advance(context);
      if (!outcome.isDone()) return outcome;
      stopped_ = true;
      since_ = context.now;
      askForOption(context);
    }
    return settle(context);
  }

 private:
  void askForOption(const Context& context) {
    AxisCore& axis = context.axis;
    context.show("stopped", "the drive to switch off or to hold (" +
                                axis.profile().address(0x605A) + " quick stop option)");
    if (axis.profile().quick_stop_holds.empty()) return;
    const ObjectSpec* object = axis.profile().find(axis.profile().own({0x605A, 0}));
    if (object != nullptr) option_ = axis.device().objects().upload(object->id, object->name);
  }

  bool holds(const AxisCore& axis) const {
    if (!option_ || !option_->ok() || option_->data().size() > 8) {
      return axis.config().quick_stop_holds;  // as it was told to
    }
    const auto value = static_cast<std::int16_t>(fieldbus::toUnsigned(option_->data()));
    const std::vector<int>& held = axis.profile().quick_stop_holds;
    return std::find(held.begin(), held.end(), value) != held.end();
  }

  Outcome settle(const Context& context) {
    AxisCore& axis = context.axis;
    const std::string joint = jointName(axis.config());
    if (axis.faulted()) {
      return Outcome::remarked(joint + ": no motion is commanded; " + axis.faults().text());
    }
    if (axis.powerOff()) {
      axis.setGoal(Goal::disabled);
      return Outcome::done(joint + ": stopped and disabled; enable to go on");
    }
    if (option_ && !option_->done()) return Outcome::running();
    if (holds(axis)) {
      return Outcome::done(joint +
                           ": stopped, holds its position in quick stop active; enable to " +
                           "go on or disable");
    }
    const Duration patience = axis.profile().timing.transition(12) / 2;
    if (context.now - since_ <= patience + axis.control().powerOffTime()) return Outcome::running();
    axis.setGoal(Goal::disabled);  // transition 12 by hand: the drive did not take it by itself
    return Outcome::remarked(joint + ": stopped; the drive stayed in quick stop active, so " +
                             "disable voltage is commanded");
  }

  QuickStopStep stop_;
  fieldbus::Ticket option_;
  bool stopped_ = false;
  Time since_{};
};

}  // namespace

Result<std::unique_ptr<Procedure>> makeQuickStop(AxisCore& axis) {
  const std::string refusal = deviceRefusal(axis, "quick-stop");
  if (!refusal.empty()) return Error{refusal};
  return std::unique_ptr<Procedure>(std::make_unique<QuickStop>());
}

}  // namespace cia402::drive
