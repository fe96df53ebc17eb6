// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include "bus/reply_log.h"
#include "bus/runner.h"
#include "config/robot.h"

namespace cia402::ros_node {

/// Brings what happens on the bus and what becomes of commands from topics into the log, and
/// emergencies to ~emergencies.
class EventLog {
 public:
  EventLog(ros::NodeHandle& private_node, bus::BusRunner& runner, bus::ReplyLog& replies,
           const config::RobotConfig& robot);

  /// Empties the queues of events and replies.
  void drain();

 private:
  void publish(const bus::EmergencyEvent& event);
  void drainReplies();

  bus::BusRunner& runner_;
  bus::ReplyLog& replies_;
  const config::RobotConfig& robot_;
  ros::Publisher emergencies_;
  std::uint64_t lost_told_ = 0, unpublished_told_ = 0, replies_lost_told_ = 0;
};

}  // namespace cia402::ros_node
