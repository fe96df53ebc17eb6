// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/shutdown.h"

#include <algorithm>

#include "bus/axis_cycle.h"

namespace cia402::bus {
namespace {

constexpr Duration kStopTime = std::chrono::milliseconds(1000);     // for the ramps
constexpr Duration kDisableTime = std::chrono::milliseconds(1800);  // from the start

void disable(drive::Axis& axis, Time now) {
  drive::ProcedureRequest request;
  request.kind = drive::ProcedureKind::disable;
  const drive::ProcedureStatus& procedure = axis.procedure();
  if (procedure.running && procedure.kind == request.kind) return;
  (void)axis.start(request, now);  // not ready: nothing to do
}

bool atRest(const AxisCycle& cycle) {
  const auto& units = cycle.units();
  const auto& groups = cycle.groups();
  return std::all_of(units.begin(), units.end(),
                     [](const AxisUnit& unit) { return unit.axis.stream().at_rest; }) &&
         std::none_of(groups.begin(), groups.end(),
                      [](const Group& group) { return group.executing() || group.stopping(); });
}

/// One that was lost as it turned is told to stop again and again, and once more when it is heard:
/// it is worth waiting for. So is one that nobody has looked at yet: a driver that is gone may have
/// left it turning.
bool disabled(const AxisCycle& cycle) {
  const auto& units = cycle.units();
  return std::none_of(units.begin(), units.end(), [](const AxisUnit& unit) {
    const fieldbus::Health health = unit.axis.state().health;
    return (health == fieldbus::Health::ready && unit.axis.procedure().running) ||
           (health == fieldbus::Health::lost && unit.axis.mayMove()) || unit.axis.beingFound();
  });
}

}  // namespace

void Shutdown::endMotion(AxisCycle& cycle, Time now) {
  cycle.stopMotion("stopped: the driver is shutting down");
  // What runs by itself would go on while the set-points of other axes are ramped down.
  for (AxisUnit& unit : cycle.units()) {
    const drive::ProcedureStatus& procedure = unit.axis.procedure();
    const bool runs = procedure.running && !drive::stops(procedure.kind);
    const bool planned_by_drive = unit.axis.setPoint().kind() == drive::SetPointKind::goal;
    if (runs || planned_by_drive) disable(unit.axis, now);
  }
}

bool Shutdown::step(AxisCycle& cycle, Time now) {
  switch (stage_) {
    case Stage::stopping:
      if (!atRest(cycle) && now < began_ + kStopTime) return false;
      stage_ = Stage::disabling;
      for (AxisUnit& unit : cycle.units()) disable(unit.axis, now);
      return false;
    case Stage::disabling:
      return disabled(cycle) || now >= began_ + kDisableTime;
    case Stage::no:
    case Stage::done:
      break;
  }
  return false;
}

}  // namespace cia402::bus
