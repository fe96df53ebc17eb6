// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>

#include <optional>
#include <string>
#include <vector>

#include "canopen/config.h"
#include "config/robot.h"
#include "ros/parameters.h"
#include "sim/world/robot_drives.h"

namespace cia402::ros_node {

/// A robot ready to run, from the node's private parameters.
struct LoadedRobot {
  NodeOptions options;
  config::RobotConfig robot;
  canopen::MasterConfig master;
  YAML::Node tree;               ///< of which it was loaded
  config::ProfileLookup lookup;  ///< by which profiles were found
};

/// Reads and checks everything; every problem is logged with its path, and nothing is returned if
/// there is one.
std::optional<LoadedRobot> loadRobot(const ros::NodeHandle& private_node);

/// The simulated drives of that robot; problems are logged, and nothing is returned if there is
/// one.
std::optional<std::vector<sim::SimulatedDrive>> loadSimulation(const config::RobotConfig& robot);

}  // namespace cia402::ros_node
