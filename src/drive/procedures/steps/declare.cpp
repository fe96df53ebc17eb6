// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/declare.h"

namespace cia402::drive {

bool DeclareStep::stands(const Context& context, Outcome& outcome) {
  if (since_ == kNever) since_ = context.now;
  outcome = awaitStandstill(context, since_, what_);
  if (!outcome.isDone()) return false;
  since_ = kNever;
  outcome = Outcome::running();
  return true;
}

Outcome DeclareStep::advance(const Context& context) {
  AxisCore& axis = context.axis;
  Outcome outcome;
  switch (phase_) {
    case Phase::standing:
    case Phase::giving_up:
      if (phase_ == Phase::standing && axis.generator().giveUpGoal()) {
        phase_ = Phase::giving_up;
        since_ = kNever;
        context.show("giving up the goal", "the axis to stand without one");
        return Outcome::running();
      }
      if (!stands(context, outcome)) return outcome;
      if (axis.generator().handingOver()) return outcome;
      phase_ = Phase::opening;
      axis.limits().open(true);
      context.show("opening position limits", "the drive to let go of those of the old zero");
      return Outcome::running();
    case Phase::opening:
      return open(context);
    case Phase::declaring:
      if (!stands(context, outcome)) return outcome;
      phase_ = Phase::closing;
      before_ = axis.state().position;
      axis.declarePosition(position_);
      axis.limits().open(false);
      context.show("writing position limits", "the drive to take those of the new zero");
      return Outcome::running();
    case Phase::closing:
      return close(context);
  }
  return Outcome::running();
}

Outcome DeclareStep::open(const Context& context) {
  AxisCore& axis = context.axis;
  if (!axis.limits().settled()) return Outcome::running();
  const std::string problem = axis.limits().problem();
  if (problem.empty()) {
    phase_ = Phase::declaring;
    return Outcome::running();
  }
  axis.limits().open(false);
  return Outcome::failed(axis.who() + ": " + what_ +
                         " is refused: the drive's position limits would be those of the old zero, "
                         "for it does not take others now" +
                         (axis.powerOff() ? "" : "; disable the axis first") + " (" + problem +
                         ")");
}

Outcome DeclareStep::close(const Context& context) {
  AxisCore& axis = context.axis;
  if (!axis.limits().settled()) return Outcome::running();
  remark_ = axis.limits().remark();
  return Outcome::done();
}

}  // namespace cia402::drive
