// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <vector>

#include "bus/runner.h"
#include "config/robot.h"
#include "ros/call_desk.h"
#include "ros/reloader.h"

namespace cia402::ros_node {

/// All services of the node, for the bus (`~name`), for each axis (`~<axis>/name`) and for each
/// group (`~<group>/name`). A call returns when what it asked for has ended. Those whose requests
/// say nothing, every one that stops motion among them, wait at the desk and never for each other;
/// the rest keep a thread of the node handle's callback queue while they wait.
class Services {
 public:
  /// @param desk, @param runner, @param reloader, @param robot must outlive the services.
  Services(ros::NodeHandle& private_node, CallDesk& desk, bus::BusRunner& runner,
           Reloader& reloader, const config::RobotConfig& robot);

 private:
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace cia402::ros_node
