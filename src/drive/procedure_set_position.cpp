// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "procedure.h"
#include "sentence.h"

namespace cia402::drive {
namespace {

/// Declares the present position by an offset in software; nothing moves, nothing is written.
class SetPosition : public Procedure {
 public:
  explicit SetPosition(double position) : position_(position) {}

  Outcome advance(const Context& context) override {
    AxisCore& axis = context.axis;
    const bool prismatic = axis.config().geometry.type == AxisGeometry::Type::prismatic;
    const double before = axis.state().position;
    const Outcome standing =
        awaitStandstill(context, context.status.started, "declaring the position");
    if (!standing.isDone()) return standing;
    axis.declarePosition(position_);
    return Outcome::done(axis.config().joint + ": the present position is declared to be " +
                         length(position_, prismatic) + " (it read " + length(before, prismatic) +
                         "); nothing moved, the axis counts as homed");
  }

 private:
  double position_;
};

}  // namespace

Result<std::unique_ptr<Procedure>> makeSetPosition(AxisCore& axis, double position) {
  if (!std::isfinite(position)) {
    return Error{axis.who() + ": set_position needs a finite number"};
  }
  const std::string refusal = nodeRefusal(axis, "declare the position");
  if (!refusal.empty()) return Error{refusal};
  return std::unique_ptr<Procedure>(std::make_unique<SetPosition>(position));
}

}  // namespace cia402::drive
