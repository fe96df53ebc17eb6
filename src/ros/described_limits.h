// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "common/problems.h"

namespace cia402::ros_node {

/// The limits of some joints in a URDF, as `limits_from` of a robot's file wants those of a source:
/// joint -> lower, upper, velocity, effort. A velocity or effort of zero counts as not given, with
/// a warning, as does a range without width.
/// @param source the name of the parameter, for messages
YAML::Node limitsOfUrdf(const std::string& urdf, const std::string& source,
                        const std::vector<std::string>& joints, Problems& problems,
                        std::vector<std::string>& warnings);

/// The same of parameters as MoveIt (`robot_description_planning/joint_limits`) and ros_control
/// (`joint_limits`) have them: joint -> has_velocity_limits, max_velocity, ...
/// @param limits the mapping, whole
YAML::Node limitsOfJointLimits(const YAML::Node& limits, const std::string& source,
                               const std::vector<std::string>& joints, Problems& problems,
                               std::vector<std::string>& warnings);

/// Names of the joints in the tree of a robot, which nobody has checked yet.
std::vector<std::string> jointNamesIn(const YAML::Node& robot);

/// Adds to a robot's tree, as `limits_from`, what `robot_description`,
/// `robot_description_planning/joint_limits` and `joint_limits` say of its joints, each sought in
/// the node's private namespace, then outwards. Warnings are logged.
void addDescribedLimits(const ros::NodeHandle& private_node, YAML::Node& robot, Problems& problems);

}  // namespace cia402::ros_node
