// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>

#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "bus/canopen/reload_command.h"
#include "bus/runner.h"
#include "config/ready_robot.h"
#include "config/reload.h"
#include "ros/robot_loader.h"

namespace cia402::ros_node {

/// Changes what can be changed of a robot while its driver runs. What is to count is loaded and
/// checked as a whole like the robot's file at the start, so that a value is refused where it would
/// have been refused then; a refusal changes nothing. Any thread; a call waits for the bus.
class Reloader {
 public:
  /// @param runner must outlive it. @param wake called after each change, by any thread
  Reloader(const ros::NodeHandle& private_node, bus::BusRunner& runner, const LoadedRobot& loaded,
           std::function<void()> wake);

  /// Reads the private parameters again. @return whether the node now does what they say, and in
  /// words what has changed, and why the rest has not
  bus::Answer reload();
  /// Changes some of tunables(). @param values by their keys, as YAML
  bus::Answer set(const std::map<std::string, std::string>& values);

  /// With their present values. Does not wait for the bus.
  std::vector<config::Tunable> tunables();
  /// Period of joint_states.
  Duration jointStatePeriod() const { return fromSeconds(1.0 / joint_state_rate_); }
  /// Counts the changes since the start.
  unsigned changes() const { return changes_; }

 private:
  using Changes = std::vector<config::Change>;

  /// @param tree of which some differs from what counts now
  bus::Answer take(const YAML::Node& tree, Changes changes);
  /// All of `changes`, none of which takes a restart, or nothing.
  bus::ReloadAnswer apply(const YAML::Node& tree, const Changes& changes);
  void show();

  ros::NodeHandle node_;
  bus::BusRunner& runner_;
  std::function<void()> wake_;
  std::mutex shown_mutex_;  // of `shown_` alone
  std::vector<config::Tunable> shown_;
  std::mutex mutex_;  // one change at a time
  // What counts now:
  NodeOptions options_;
  config::ProfileLookup lookup_;
  YAML::Node tree_;
  config::ReadyRobot ready_;
  std::atomic<double> joint_state_rate_;
  std::atomic<unsigned> changes_{0};
};

}  // namespace cia402::ros_node
