// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bus/snapshot.h"
#include "config/robot.h"
#include "motion/joint.h"

namespace cia402::ros_node {

/// Adds where the joints of a group are to be, and are, in the group's order.
/// @param message with joint_names, desired, actual and error, as those of control_msgs have them
/// @param joints in the order of the snapshot
template <typename Message>
void addGroup(const config::GroupConfig& group, const std::vector<motion::Joint>& joints,
              const bus::NetworkSnapshot& snapshot, Message& message) {
  for (const std::string& name : group.joints) {
    for (std::size_t i = 0; i < snapshot.joints.size(); ++i) {
      if (joints[i].name != name) continue;
      const bus::JointState& joint = snapshot.joints[i];
      message.joint_names.push_back(name);
      message.desired.positions.push_back(joint.desired);
      message.desired.velocities.push_back(joint.desired_velocity);
      message.actual.positions.push_back(joint.position);
      message.actual.velocities.push_back(joint.velocity);
      message.error.positions.push_back(joint.desired - joint.position);
      message.error.velocities.push_back(joint.desired_velocity - joint.velocity);
    }
  }
}

}  // namespace cia402::ros_node
