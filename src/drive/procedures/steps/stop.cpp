// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/stop.h"

#include "drive/procedures/limits.h"
#include "drive/sentence.h"

namespace cia402::drive {

void QuickStopStep::begin(const Context& context) {
  AxisCore& axis = context.axis;
  begun_ = true;
  started_ = context.now;
  const bool turns = axis.inOperation() && !axis.feedback().seenToStand(context.now);
  if (turns && axis.stops().byMode()) axis.stops().halt(context.now);
  brakes_ = turns && axis.mode().brakes() && axis.inOperation();
  if (brakes_) return context.show("braking", "mode " + axis.mode().spec().name + " to brake");
  axis.setGoal(Goal::quick_stop);
  context.show("stopping", "the quick stop ramp to end at standstill");
}

/// The other mode has yet to bring the axis to rest, and has the time for it.
bool QuickStopStep::brakes(const Context& context) const {
  AxisCore& axis = context.axis;
  const bool rests = axis.generator().sent().atRest() && axis.feedback().seenToStand(context.now);
  const Duration longest = stopTime(axis.config(), axis.state().velocity);
  return axis.inOperation() && !rests && context.now - started_ <= longest;
}

Outcome QuickStopStep::advance(const Context& context) {
  AxisCore& axis = context.axis;
  if (!begun_) {
    begin(context);
    return Outcome::running();
  }
  if (brakes_) {
    if (brakes(context)) return Outcome::running();
    brakes_ = false;
    started_ = context.now;
    axis.setGoal(Goal::quick_stop);
    context.show("stopping", "the quick stop to end at standstill");
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
