// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <string>
#include <vector>

#include "cia402_driver/bus/runner.h"
#include "cia402_driver/config/robot.h"

namespace cia402::ros_node {

/// All services of the node, for the bus (`~name`) and for each axis (`~<axis>/name`). A call
/// returns when its procedure has ended; give the node handle a callback queue with threads to
/// spare, for each waiting call keeps one.
class Services {
 public:
  Services(ros::NodeHandle& private_node, bus::BusRunner& runner, const config::RobotConfig& robot);

  /// Calls that may wait at the same time: one for each service of each axis would be too many, so
  /// one for each axis and some for the bus.
  static unsigned threads(const config::RobotConfig& robot);

 private:
  void advertise(ros::NodeHandle node, const std::string& axis);
  void advertiseSaveDcf(ros::NodeHandle& node, const drive::AxisConfig& axis);
  void advertiseTrigger(ros::NodeHandle& node, const char* name, const std::string& axis,
                        drive::ProcedureKind kind);
  void advertiseDump(ros::NodeHandle& node);
  void advertiseHistory(ros::NodeHandle& node, const std::string& axis);
  /// Posts the command and waits for its reply.

  bus::BusRunner& runner_;
  const config::RobotConfig& robot_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace cia402::ros_node
