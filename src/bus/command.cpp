// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/command.h"

#include <vector>

#include "bus/axis_cycle.h"
#include "bus/coupled_axes.h"

namespace cia402::bus {

void SetpointCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time now) const {
  std::vector<AxisUnit>& units = cycle.units();
  if (axis >= units.size()) return;
  if (const CoupledAxes* coupling = units[axis].coupling) {
    return refuse(reply, coupling->streamRefusal(units[axis].axis.config()));
  }
  const Result<void> taken = units[axis].axis.command(value, now);
  if (!taken) refuse(reply, taken.error().message);
}

void TrajectoryCommand::begin(AxisCycle& cycle, const Reply<Answer>& reply, Time now) const {
  for (Group& candidate : cycle.groups()) {
    if (candidate.config().name != group) continue;
    const TrajectoryOutcome outcome = candidate.start(*this, now);
    Answer answer;
    answer.success = outcome.code == motion::TrajectoryErrorCode::successful;
    answer.message = outcome.message;
    answer.code = outcome.code;
    answer.passed_points = outcome.passed_points;
    return give(reply, answer);
  }
  refuse(reply, "there is no group \"" + group + "\"");
}

void CancelCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time) const {
  for (Group& candidate : cycle.groups()) {
    if (candidate.config().name == group) candidate.cancel(id);
  }
  give(reply, answerOf(true, group + ": cancelled"));
}

void CallCommand::begin(AxisCycle&, const Reply<>& reply, Time now) const {
  give(reply, function(now));
}

}  // namespace cia402::bus
