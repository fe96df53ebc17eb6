// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "step_stop.h"

#include "sentence.h"

namespace cia402::drive {

Outcome QuickStopStep::advance(const Context& context) {
  AxisCore& axis = context.axis;
  if (!begun_) {
    begun_ = true;
    started_ = context.now;
    axis.setGoal(Goal::quick_stop);
    context.show("stopping", "the quick stop ramp to end at standstill");
    return Outcome::running();
  }
  const State state = axis.state().state;
  if (axis.powerOff()) return Outcome::done();
  if (state == State::quick_stop_active && axis.atStandstill()) return Outcome::done();
  if (context.now - started_ <= axis.profile().timing.state_change) return Outcome::running();
  return Outcome::failed(axis.who() + ": the quick stop did not end at standstill within " +
                         seconds(context.now - started_) + "; " + axis.report());
}

}  // namespace cia402::drive
