// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "config/robot.h"
#include "yaml/reader.h"

namespace cia402::config {

/// Limits of joints that others than the robot's file state (`limits_from`): its description, what
/// motion planning is configured with. Of all that is stated of a joint the strictest counts.
class DescribedLimits {
 public:
  struct Stated {
    std::string source;  ///< "robot_description"
    motion::JointLimits limits;
    yaml::Value value;
  };

  DescribedLimits() = default;
  /// Of a mapping source -> joint -> limits. What is wrong in it becomes problems.
  explicit DescribedLimits(const yaml::Value& value);

  /// Whose limits they are in the robot's file.
  struct Owner {
    motion::Joint joint;
    std::string place;     ///< where its own stand, for messages: "axes/m3/limits"
    bool coupled = false;  ///< has neither limit of jerk nor of effort
  };
  /// The strictest of what is stated for a joint and its own; where they exclude each other that is
  /// a problem.
  /// @param robot its warnings get what differs, its notes what is stated elsewhere alone
  motion::JointLimits strictest(const Owner& own, Problems& problems, RobotConfig& robot) const;
  /// To be called when all joints were asked for: others become problems.
  void finish(const std::vector<std::string>& joints) const;

 private:
  std::map<std::string, std::vector<Stated>> stated_;  // by joint
};

/// The axes that `couplings` name: their limits are not those of joints. Reads no more than that.
std::set<std::string> coupledAxes(const YAML::Node& tree);

/// Writes what the limits of axes came out as into a tree that they are loaded from, and takes it
/// out of `limits_from`, which keeps those of coupled joints.
void settleLimits(YAML::Node& tree, const RobotConfig& robot);

}  // namespace cia402::config
