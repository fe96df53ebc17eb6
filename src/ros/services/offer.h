// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <string>
#include <utility>
#include <vector>

#include "bus/jobs/procedure_command.h"
#include "bus/runner.h"
#include "config/robot.h"
#include "ros/call_desk.h"
#include "ros/command_call.h"
#include "ros/reloader.h"

namespace cia402::ros_node {

/// Where the services of the bus, of one axis or of one group are offered, and what they work with.
struct Offer {
  ros::NodeHandle node;                        ///< of their names
  const drive::AxisConfig* axis = nullptr;     ///< nullptr: those of the bus or of a group
  const config::GroupConfig* group = nullptr;  ///< nullptr: those of the bus or of an axis
  CallDesk& desk;
  bus::BusRunner& runner;
  Reloader& reloader;
  const config::RobotConfig& robot;
  std::vector<ros::ServiceServer>& servers;

  /// For commands: of one axis, or empty for all.
  std::string name() const { return axis == nullptr ? std::string() : axis->name; }
  /// A procedure on what they are of.
  bus::ProcedureCommand procedure(drive::ProcedureKind kind) const {
    bus::ProcedureCommand command;
    command.axis = name();
    command.request.kind = kind;
    if (group != nullptr) command.group = group->name;
    return command;
  }
  /// A service that keeps a thread until it is answered.
  /// @param serve (const Request&, Response&)
  template <typename Service, typename Serve>
  void serve(const char* service, Serve serve) {
    using Request = typename Service::Request;
    using Response = typename Service::Response;
    servers.push_back(node.advertiseService<Request, Response>(
        service, [serve = std::move(serve)](Request& request, Response& response) {
          serve(request, response);
          return true;
        }));
  }
};

}  // namespace cia402::ros_node
