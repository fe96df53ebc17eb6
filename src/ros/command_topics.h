// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "bus/fixed_text.h"
#include "bus/mpsc_queue.h"
#include "bus/reply_log.h"
#include "bus/runner.h"
#include "cia402_driver/motion/trajectory_error.h"
#include "config/robot.h"

namespace cia402::ros_node {

/// Subscribes ~<axis>/command, ~<group>/commands and ~<group>/command. What is refused is told in
/// the log; what became of a trajectory also on ~<group>/command_result, for programs.
class CommandTopics {
 public:
  /// @param replies where refusals go. @param wake called where update() has something to do; any
  /// thread, must not wait. Both, and this, must outlive the thread of `runner`.
  CommandTopics(ros::NodeHandle& private_node, bus::BusRunner& runner, bus::ReplyLog& replies,
                std::function<void()> wake, const config::RobotConfig& robot);

  /// One thread: publishes what became of trajectories.
  void update();

 private:
  /// Of a trajectory for the group of that number, from the thread of the bus.
  struct Result {
    std::size_t group = 0;
    motion::TrajectoryErrorCode code = motion::TrajectoryErrorCode::successful;
    bus::FixedText<512> text;
  };

  void onSetpoint(std::size_t axis, const std_msgs::Float64& message);
  void onSetpoints(std::size_t group, const std_msgs::Float64MultiArray& message);
  void onTrajectory(std::size_t group, const trajectory_msgs::JointTrajectory& message);
  void add(std::size_t group, motion::TrajectoryErrorCode code, const std::string& text);

  bus::BusRunner& runner_;
  bus::ReplyLog& replies_;
  std::function<void()> wake_;
  std::vector<std::string> groups_;  ///< their names
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::Publisher> result_pubs_;  ///< of each group
  bus::MpscQueue<Result> results_;
};

/// The message as a command for a group; its start in the time of the bus.
bus::TrajectoryCommand trajectoryCommand(const std::string& group,
                                         const trajectory_msgs::JointTrajectory& message,
                                         const bus::BusTime& time);

}  // namespace cia402::ros_node
