// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// People look for devices without a node-ID, and give them one.
#include "bus/canopen/lss_commands.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "bus/canopen/lss_supervisor.h"
#include "bus/network.h"
#include "canopen/lss/scan.h"
#include "common/text.h"

namespace cia402::bus {
namespace {

namespace lss = canopen::lss;

LssScanAnswer scanAnswer(const config::RobotConfig& robot, const canopen::LssScanTask& scan,
                         const std::string& error) {
  LssScanAnswer answer;
  answer.success = error.empty() && !scan.incomplete();
  answer.message = error.empty() ? scan.result() : error;
  for (const lss::Identity& identity : scan.found()) {
    answer.devices.push_back(identity);
    answer.device_axes.emplace_back();
    std::string owner;
    for (const drive::AxisConfig& axis : robot.axes) {
      const auto& assigned = robot.deviceOf(axis).lss;
      if (!assigned || !(assigned->identity == identity)) continue;
      answer.device_axes.back() = axis.name;
      owner = " is that of " + drive::whoIs(axis);
    }
    append(answer.message, toString(identity) + owner);
  }
  return answer;
}

std::string nodeIdRefusal(int node_id, const LssSupervisor& supervisor, canopen::NodeId own) {
  const std::string number = "refused: node-ID " + std::to_string(node_id);
  if (node_id < 1 || node_id > 127) return number + " is not in 1..127";
  const std::vector<canopen::NodeId> in_use = supervisor.nodesInOperation();
  if (std::find(in_use.begin(), in_use.end(), node_id) == in_use.end()) return {};
  return number + (node_id == own ? " is the master's own" : " is that of a drive in operation");
}

}  // namespace

void LssScanCommand::begin(Network& network, const Reply<LssScanAnswer>& reply, Time) const {
  AxisCycle& cycle = network.cycle();
  const std::string refusal = cycle.motionProblem();
  if (!refusal.empty()) return refuse(reply, refusal);
  network.lss().desk().add(
      "", std::make_unique<canopen::LssScanTask>(),
      [&robot = network.config(), reply](const canopen::LssTask& task, const std::string& error,
                                         Time) {
        give(reply, scanAnswer(robot, static_cast<const canopen::LssScanTask&>(task), error));
      },
      [&cycle] { return cycle.motionProblem(); }, window);
}

void LssAssignCommand::begin(Network& network, const Reply<>& reply, Time) const {
  AxisCycle& cycle = network.cycle();
  LssSupervisor& supervisor = network.lss();
  std::string refusal = nodeIdRefusal(node_id, supervisor, network.config().bus.node_id);
  if (refusal.empty()) refusal = cycle.motionProblem();
  if (!refusal.empty()) return refuse(reply, refusal);
  const auto node = static_cast<canopen::NodeId>(node_id);
  canopen::LssAssignTask::Options options;
  options.identity = identity;
  options.node_id = node;
  options.store = store;
  options.in_use = [&supervisor] { return supervisor.nodesInOperation(); };
  supervisor.desk().add(
      "", std::make_unique<canopen::LssAssignTask>(std::move(options), supervisor.sink()),
      [&master = network.master(), reply, device = toString(identity), node](
          const canopen::LssTask& task, const std::string& error, Time now) {
        const bool success = error.empty();
        canopen::Node* const own = success ? master.find(node) : nullptr;
        if (own != nullptr) LssSupervisor::lookSoon(*own, now);
        give(reply, answerOf(success, device + ": " + (success ? task.result() : error)));
      },
      [&cycle] { return cycle.motionProblem(); });
}

}  // namespace cia402::bus
