// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/command.h"

#include <vector>

#include "bus/axis_cycle.h"

namespace cia402::bus {

void SetpointCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time now) const {
  std::vector<AxisUnit>& units = cycle.units();
  if (axis >= units.size()) return;
  const Result<void> taken = units[axis].axis.command(value, now);
  if (!taken) refuse(reply, taken.error().message);
}

void TrajectoryCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time now) const {
  for (Group& candidate : cycle.groups()) {
    if (candidate.config().name != group) continue;
    const TrajectoryOutcome outcome = candidate.start(joints, points, start_time, now, ended);
    const bool accepted = outcome.code == motion::TrajectoryErrorCode::successful;
    return give(reply, answerOf(accepted, outcome.message));
  }
  refuse(reply, "there is no group \"" + group + "\"");
}

void CallCommand::begin(AxisCycle&, const Reply<>& reply, Time now) const {
  give(reply, function(now));
}

}  // namespace cia402::bus
