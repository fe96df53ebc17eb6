// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <XmlRpcValue.h>
#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

#include <string>

#include "common/problems.h"

namespace cia402::ros_node {

/// A parameter tree as the configuration reader wants it. Values that YAML cannot hold (dates,
/// binaries) become problems.
YAML::Node toYaml(XmlRpc::XmlRpcValue value, const std::string& path, Problems& problems);

/// What the node itself takes from its private namespace, beside the robot.
struct NodeOptions {
  std::string interface;  ///< `~interface`: overrides bus/interface (roslaunch can:=..., sim:=true)
  std::string profile_path;  ///< `~profile_path`: further folder of drive profiles
  /// `~limits_from_parameters`: the limits of robot_description and joint_limits count, too
  bool limits_from_parameters = true;
  int realtime_priority = 80;  ///< `~realtime_priority`: 0 leaves scheduling and memory alone
};

/// The node's private parameters, split into its own and the robot's tree.
struct Parameters {
  NodeOptions options;
  YAML::Node robot;
};
Parameters readParameters(const ros::NodeHandle& private_node, Problems& problems);

}  // namespace cia402::ros_node
