// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/procedure_command.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "bus/axis_cycle.h"
#include "bus/coupled_axes.h"
#include "bus/jobs/procedure_job.h"

namespace cia402::bus {
namespace {

/// What is done to one side of a gantry is done to the other; parameters are the drive's own.
bool ofBothSides(drive::ProcedureKind kind) {
  return kind != drive::ProcedureKind::save_parameters &&
         kind != drive::ProcedureKind::restore_parameters;
}

int homingOrder(const drive::AxisConfig& axis) { return axis.homing ? axis.homing->order : 0; }

}  // namespace

bool ProcedureCommand::concerns(const AxisUnit& unit, const config::GroupConfig* of) const {
  const drive::AxisConfig& config = unit.axis.config();
  const CoupledAxes* coupling = unit.coupling;
  if (!axis.empty()) {
    const bool with_it = coupling != nullptr && coupling->asOne() && coupling->config().has(axis);
    return config.name == axis || (with_it && ofBothSides(request.kind));
  }
  if (request.kind == drive::ProcedureKind::home && !config.homing) return false;
  return of == nullptr ||
         std::any_of(of->joints.begin(), of->joints.end(), [&](const std::string& joint) {
           return coupling != nullptr ? coupling->config().moves(joint) : config.joint == joint;
         });
}

void ProcedureCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time now) const {
  const std::string problem = enables(request.kind) ? cycle.enableProblem() : std::string();
  if (!problem.empty()) {
    return refuse(reply, std::string(drive::toString(request.kind)) + " is refused: " + problem);
  }
  const auto of = std::find_if(cycle.groups().begin(), cycle.groups().end(),
                               [&](const Group& any) { return any.config().name == group; });
  const bool of_group = of != cycle.groups().end();
  if (!group.empty() && !of_group) return refuse(reply, "there is no group `" + group + "`");
  const bool homing = request.kind == drive::ProcedureKind::home;
  std::vector<AxisUnit*> units;
  std::vector<ProcedureJob::Item> items;
  std::string left_out;
  for (AxisUnit& unit : cycle.units()) {
    if (!concerns(unit, of_group ? &of->config() : nullptr)) continue;
    if (axis.empty() && unit.axis.device().excused()) {
      left_out += ProcedureJob::leftOut(unit.axis);
      continue;
    }
    units.push_back(&unit);
    items.push_back({&unit.axis, homing ? homingOrder(unit.axis.config()) : 0, unit.index});
    if (stops(request.kind)) cycle.jobs().withdraw(unit.axis, request.kind);
  }
  if (items.empty()) {
    return refuse(reply, !axis.empty()      ? noSuchAxis(axis)
                         : left_out.empty() ? "nothing to do: no axis" +
                                                  (of_group ? " of " + group : std::string()) +
                                                  " has a `homing` section"
                                            : "nothing to do" + left_out);
  }
  const std::string busy =
      homing ? ProcedureJob::homingRefusal(cycle.jobs(), items) : std::string();
  if (!busy.empty()) return refuse(reply, busy);
  // Until the devices can be reached again, where that takes more than their boot.
  const bool held = request.kind == drive::ProcedureKind::recover && cycle.prepareRecovery(units);
  ProcedureJob::Manner manner;
  manner.held = held;
  manner.together = of_group || (!axis.empty() && items.size() > 1);
  auto job = std::make_unique<ProcedureJob>(request, std::move(items), std::move(left_out),
                                            std::move(manner), reply);
  if (!job->step(now)) cycle.jobs().add(std::move(job));
}

}  // namespace cia402::bus
