// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/stop.h"

#include "drive/procedures/limits.h"
#include "drive/sentence.h"

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
  const bool off = axis.powerOff();
  const bool stopped = off || axis.state().state == State::quick_stop_active;
  const bool at_rest = off ? !axis.feedback().mayMove() : axis.feedback().atStandstill();
  if (stopped && at_rest) return Outcome::done();
  const Duration waited = context.now - started_;
  if (waited <= stopTime(axis.config(), axis.state().velocity)) return Outcome::running();
  if (off) {
    return Outcome::failed(axis.who() + ": the power stage is off, but after " + seconds(waited) +
                           " " + axis.feedback().coastingText());
  }
  return Outcome::failed(axis.who() + ": the quick stop did not end at standstill within " +
                         seconds(waited) + "; " + report(axis));
}

}  // namespace cia402::drive
