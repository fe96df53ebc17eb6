// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/command.h"

#include <algorithm>
#include <vector>

#include "bus/axis_cycle.h"
#include "bus/coupled_axes.h"
#include "common/text.h"

namespace cia402::bus {
namespace {

/// What waited for too long is not followed any more; empty: it did not.
std::string staleness(Time came, Duration timeout, Time now) {
  if (now - came <= timeout) return {};
  return "it waited for " + secondsText(now - came) +
         " until the thread of the bus took it, longer than command_timeout (" +
         secondsText(timeout) + "); see that nothing keeps the driver from its cycle";
}

std::string namesOf(const std::vector<Joint*>& joints) {
  std::string names;
  for (const Joint* joint : joints) append(names, joint->name(), ", ");
  return names;
}

/// A number is a position, a velocity or an effort for all joints of a group.
std::string mixtureOf(const std::vector<Joint*>& joints) {
  const auto differs = [&](const Joint* joint) {
    return joint->mode()->kind != joints.front()->mode()->kind;
  };
  if (std::none_of(joints.begin(), joints.end(), differs)) return {};
  std::string modes;
  for (const Joint* joint : joints) {
    append(modes, joint->name() + " is in mode " + joint->mode()->name, ", ");
  }
  return modes + ": positions, velocities and efforts are not taken together; set_mode first";
}

/// Why a group does not take set-points; empty if it does.
std::string refusalOf(const std::vector<Joint*>& joints, const std::vector<double>& values,
                      Time came, Time now) {
  if (values.size() != joints.size()) {
    return std::to_string(values.size()) + " came for " + std::to_string(joints.size()) +
           " joints, which are in this order: " + namesOf(joints);
  }
  std::string all;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string why = joints[i]->commandRefusal(values[i]);
    if (!why.empty()) append(all, why);
  }
  if (!all.empty()) return all;
  Duration timeout = joints.front()->commandTimeout();
  for (const Joint* joint : joints) timeout = std::min(timeout, joint->commandTimeout());
  const std::string stale = staleness(came, timeout, now);
  return stale.empty() ? mixtureOf(joints) : stale;
}

}  // namespace

void SetpointCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time now) const {
  std::vector<AxisUnit>& units = cycle.units();
  if (axis >= units.size()) return;
  if (const CoupledAxes* coupling = units[axis].coupling) {
    return refuse(reply, coupling->streamRefusal(units[axis].axis.config()));
  }
  drive::Axis& target = units[axis].axis;
  const Time at = std::min(came.value_or(now), now);
  const std::string stale = staleness(at, target.config().command_timeout, now);
  if (!stale.empty()) {
    return refuse(reply, drive::jointName(target.config()) + ": set-point refused: " + stale);
  }
  const Result<void> taken = target.command(value, at);
  if (!taken) refuse(reply, taken.error().message);
}

void GroupSetpointsCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time now) const {
  if (group >= cycle.groups().size()) return;
  const Group& target = cycle.groups()[group];
  const Time at = std::min(came.value_or(now), now);
  std::string why = refusalOf(target.joints(), values, at, now);
  for (std::size_t i = 0; why.empty() && i < values.size(); ++i) {
    const Result<void> taken = target.joints()[i]->command(values[i], at);
    if (!taken) why = taken.error().message;
  }
  if (!why.empty()) {
    refuse(reply, target.config().name + ": set-points refused, nothing moves for them: " + why);
  }
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
    answer.slowed = outcome.slowed;
    return give(reply, answer);
  }
  refuse(reply, "there is no group \"" + group + "\"");
}

void CancelCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time now) const {
  for (Group& candidate : cycle.groups()) {
    if (candidate.config().name == group) candidate.cancel(id, now);
  }
  give(reply, answerOf(true, group + ": cancelled"));
}

void PlannedStateCommand::begin(AxisCycle& cycle, const Reply<Answer>& reply, Time now) const {
  for (const Group& candidate : cycle.groups()) {
    if (candidate.config().name != group) continue;
    Answer answer;
    for (const Joint* joint : candidate.joints()) {
      const auto state = candidate.stateAt(*joint, time, now);
      if (!state) return refuse(reply, group + ": " + state.error().message);
      answer.joints.push_back(joint->name());
      answer.states.push_back(*state);
    }
    answer.success = true;
    return give(reply, answer);
  }
  refuse(reply, "there is no group \"" + group + "\"");
}

void CallCommand::begin(AxisCycle&, const Reply<>& reply, Time now) const {
  give(reply, function(now));
}

}  // namespace cia402::bus
