// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/services.h"

#include "ros/services/table.h"

namespace cia402::ros_node {

Services::Services(ros::NodeHandle& private_node, CallDesk& desk, bus::BusRunner& runner,
                   const config::RobotConfig& robot) {
  Offer of_bus{private_node, nullptr, desk, runner, robot, servers_};
  for (const ServiceEntry& service : kServices) {
    if (service.of_bus) service.offer(of_bus);
  }
  for (const drive::AxisConfig& axis : robot.axes) {
    Offer of_axis{ros::NodeHandle(private_node, axis.name), &axis, desk, runner, robot, servers_};
    for (const ServiceEntry& service : kServices) {
      if (service.of_axis) service.offer(of_axis);
    }
  }
}

}  // namespace cia402::ros_node
