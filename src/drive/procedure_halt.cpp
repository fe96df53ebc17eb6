// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "procedure.h"
#include "sentence.h"

namespace cia402::drive {
namespace {

/// Stops an enabled axis and keeps it enabled: by controlword bit 8 in modes in which the drive
/// plans its motion, by ramping the set-points down in cyclic modes and on drives without halt. The
/// halt lasts until `enable` releases it.
class Halt : public Procedure {
 public:
  Outcome advance(const Context& context) override {
    AxisCore& axis = context.axis;
    if (!begun_) {
      begun_ = true;
      started_ = context.now;
      context.status.deadline = context.now + axis.profile().timing.state_change;
      if (!axis.inOperation()) {
        if (axis.goal() == Goal::enabled) {  // the procedure before was switching it on
          axis.setGoal(Goal::disabled);
          return Outcome::done(axis.config().joint +
                               ": was being enabled, is switched off again instead");
        }
        return Outcome::done(axis.config().joint + ": is not enabled, so nothing is to be halted");
      }
      axis.beginHalt();
      context.show("halting", "standstill");
      return Outcome::running();
    }
    if (axis.rampFinished() && axis.atStandstill()) {
      return Outcome::done(axis.config().joint + ": halted at " +
                           length(axis.state().position, prismatic(axis)) +
                           "; enable releases the halt");
    }
    if (context.now < context.status.deadline) return Outcome::running();
    const std::string velocity = number(axis.state().velocity);
    axis.setGoal(Goal::quick_stop);
    return Outcome::failed(axis.who() + ": halt did not bring the axis to standstill within " +
                           seconds(context.now - started_) + " (velocity " + velocity +
                           "); quick stop is commanded. " + axis.report());
  }

 private:
  static bool prismatic(const AxisCore& axis) {
    return axis.config().geometry.type == AxisGeometry::Type::prismatic;
  }
  bool begun_ = false;
  Time started_{};
};

}  // namespace

Result<std::unique_ptr<Procedure>> makeHalt(AxisCore& axis) {
  const std::string refusal = nodeRefusal(axis, "halt");
  if (!refusal.empty()) return Error{refusal};
  return std::unique_ptr<Procedure>(std::make_unique<Halt>());
}

}  // namespace cia402::drive
