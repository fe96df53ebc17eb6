// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <std_msgs/Float64.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <string>
#include <vector>

#include "bus/reply_log.h"
#include "bus/runner.h"
#include "config/robot.h"

namespace cia402::ros_node {

/// Subscribes ~<axis>/command and ~<group>/command. What is refused is told in the log.
class CommandTopics {
 public:
  /// @param replies where refusals go; must outlive the thread of `runner`.
  CommandTopics(ros::NodeHandle& private_node, bus::BusRunner& runner, bus::ReplyLog& replies,
                const config::RobotConfig& robot);

 private:
  void onSetpoint(std::size_t axis, const std_msgs::Float64& message);
  void onTrajectory(const std::string& group, const trajectory_msgs::JointTrajectory& message);

  bus::BusRunner& runner_;
  bus::ReplyLog& replies_;
  std::vector<ros::Subscriber> subscribers_;
};

/// The message as a command for a group; its start in the time of the bus.
bus::TrajectoryCommand trajectoryCommand(const std::string& group,
                                         const trajectory_msgs::JointTrajectory& message,
                                         const bus::BusTime& time);

}  // namespace cia402::ros_node
