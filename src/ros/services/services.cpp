// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/services.h"

#include "ros/services/table.h"

namespace cia402::ros_node {

Services::Services(ros::NodeHandle& private_node, CallDesk& desk, bus::BusRunner& runner,
                   Reloader& reloader, const config::RobotConfig& robot) {
  const auto offer = [&](const ros::NodeHandle& node, const drive::AxisConfig* axis,
                         const config::GroupConfig* group, bool ServiceEntry::*concerned) {
    Offer all{node, axis, group, desk, runner, reloader, robot, servers_};
    for (const ServiceEntry& service : kServices) {
      if (service.*concerned) service.offer(all);
    }
  };
  offer(private_node, nullptr, nullptr, &ServiceEntry::of_bus);
  for (const drive::AxisConfig& axis : robot.axes) {
    offer(ros::NodeHandle(private_node, axis.name), &axis, nullptr, &ServiceEntry::of_axis);
  }
  for (const config::GroupConfig& group : robot.groups) {
    offer(ros::NodeHandle(private_node, group.name), nullptr, &group, &ServiceEntry::of_group);
  }
}

}  // namespace cia402::ros_node
