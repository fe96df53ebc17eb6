// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/command_topics.h"

#include <boost/function.hpp>

#include "ros/clock_map.h"

namespace cia402::ros_node {

bus::TrajectoryCommand trajectoryCommand(const std::string& group,
                                         const trajectory_msgs::JointTrajectory& message,
                                         const bus::BusTime& time) {
  bus::TrajectoryCommand command;
  command.group = group;
  command.joints = message.joint_names;
  for (const trajectory_msgs::JointTrajectoryPoint& point : message.points) {
    command.points.push_back({point.positions, point.velocities, point.accelerations,
                              Duration(point.time_from_start.toNSec())});
  }
  if (!message.header.stamp.isZero()) command.start_time = fromRos(time, message.header.stamp);
  return command;
}

CommandTopics::CommandTopics(ros::NodeHandle& private_node, bus::BusRunner& runner,
                             bus::ReplyLog& replies, const config::RobotConfig& robot)
    : runner_(runner), replies_(replies) {
  for (std::size_t i = 0; i < robot.axes.size(); ++i) {
    const boost::function<void(const std_msgs::Float64&)> callback =
        [this, i](const std_msgs::Float64& message) { onSetpoint(i, message); };
    subscribers_.push_back(private_node.subscribe<const std_msgs::Float64&>(
        robot.axes[i].name + "/command", 1, callback, ros::VoidConstPtr(),
        ros::TransportHints().tcpNoDelay()));
  }
  for (const config::GroupConfig& group : robot.groups) {
    const std::string name = group.name;
    const boost::function<void(const trajectory_msgs::JointTrajectory&)> callback =
        [this, name](const trajectory_msgs::JointTrajectory& message) {
          onTrajectory(name, message);
        };
    subscribers_.push_back(private_node.subscribe<const trajectory_msgs::JointTrajectory&>(
        name + "/command", 1, callback));
  }
}

void CommandTopics::onSetpoint(std::size_t axis, const std_msgs::Float64& message) {
  runner_.post(bus::Command(bus::SetpointCommand{axis, message.data}, replies_.toSetpoint(axis)));
}

void CommandTopics::onTrajectory(const std::string& group,
                                 const trajectory_msgs::JointTrajectory& message) {
  runner_.post(
      bus::Command(trajectoryCommand(group, message, runner_.time()), replies_.toTrajectory()));
}

}  // namespace cia402::ros_node
