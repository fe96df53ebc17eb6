// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/declare.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// Declares the present position by an offset in software, which the drive's position limits
/// follow; nothing moves.
class SetPosition : public Procedure {
 public:
  explicit SetPosition(double position)
      : position_(position), declaring_(position, "declaring the position") {}

  Outcome advance(const Context& context) override {
    AxisCore& axis = context.axis;
    const bool prismatic = axis.config().geometry.prismatic();
    const Outcome declared = declaring_.advance(context);
    if (!declared.isDone()) return declared;
    return Outcome::done(jointName(axis.config()) + ": the present position is declared to be " +
                         length(position_, prismatic) + " (it read " +
                         length(declaring_.before(), prismatic) +
                         "); nothing moved, the axis counts as homed" + declaring_.remark());
  }

 private:
  double position_;
  DeclareStep declaring_;
};

}  // namespace

Result<std::unique_ptr<Procedure>> makeSetPosition(AxisCore& axis, double position) {
  if (!std::isfinite(position)) {
    return Error{axis.who() + ": set_position needs a finite number"};
  }
  const std::string refusal = deviceRefusal(axis, "declare the position");
  if (!refusal.empty()) return Error{refusal};
  return std::unique_ptr<Procedure>(std::make_unique<SetPosition>(position));
}

}  // namespace cia402::drive
