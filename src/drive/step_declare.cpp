// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "step_declare.h"

namespace cia402::drive {

bool DeclareStep::await(const Context& context, Phase next, Outcome& outcome) {
  if (since_ == kNever) since_ = context.now;
  outcome = awaitStandstill(context, since_, what_);
  if (!outcome.isDone()) return false;
  since_ = kNever;
  phase_ = next;
  return true;
}

Outcome DeclareStep::advance(const Context& context) {
  AxisCore& axis = context.axis;
  Outcome outcome;
  switch (phase_) {
    case Phase::standing:
      if (!await(context, Phase::opening, outcome)) return outcome;
      axis.openLimits(true);
      context.show("opening position limits", "the drive to let go of those of the old zero");
      return Outcome::running();
    case Phase::opening:
      return open(context);
    case Phase::declaring:
      if (!await(context, Phase::closing, outcome)) return outcome;
      before_ = axis.state().position;
      axis.declarePosition(position_);
      axis.openLimits(false);
      context.show("writing position limits", "the drive to take those of the new zero");
      return Outcome::running();
    case Phase::closing:
      return close(context);
  }
  return Outcome::running();
}

Outcome DeclareStep::open(const Context& context) {
  AxisCore& axis = context.axis;
  if (!axis.limitsSettled()) return Outcome::running();
  const std::string problem = axis.limits().problem();
  if (problem.empty()) {
    phase_ = Phase::declaring;
    return Outcome::running();
  }
  axis.openLimits(false);
  return Outcome::failed(axis.who() + ": " + what_ +
                         " is refused: the drive's position limits would be those of the old zero, "
                         "for it does not take others now" +
                         (axis.powerOff() ? "" : "; disable the axis first") + " (" + problem +
                         ")");
}

Outcome DeclareStep::close(const Context& context) {
  AxisCore& axis = context.axis;
  if (!axis.limitsSettled()) return Outcome::running();
  remark_ = axis.limits().remark();
  return Outcome::done();
}

}  // namespace cia402::drive
