// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/factory_reset.h"

#include "bus/axis_cycle.h"
#include "bus/jobs/procedure_command.h"
#include "drive/procedures/parameter_step.h"

namespace cia402::bus {
namespace {

std::string unconfirmed(const drive::AxisConfig& axis) {
  const bool by_object = !axis.profile->parameters.recipes.restore.object.empty();
  return drive::whoIs(axis) +
         ": nothing was restored: all that was set in the drive would be lost" +
         (by_object ? ", by " + drive::restoreText(*axis.profile) : std::string(", by 1011h")) +
         "; call it again with confirm: true";
}

}  // namespace

void FactoryResetCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time now) const {
  AxisUnit* const unit = cycle.find(axis);
  if (unit == nullptr) return refuse(reply, noSuchAxis(axis));
  drive::ProcedureRequest request;
  request.kind = drive::ProcedureKind::restore_parameters;
  request.confirmed = true;
  if (confirm) return ProcedureCommand{axis, request}.begin(cycle, reply, now);
  const std::string why_not = unit->axis.refusal(request);
  refuse(reply, why_not.empty() ? unconfirmed(unit->axis.config()) : why_not);
}

}  // namespace cia402::bus
