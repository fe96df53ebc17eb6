// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sensor_msgs/JointState.h>

#include <optional>
#include <vector>

#include "bus/snapshot.h"
#include "motion/joint.h"
#include "ros/stamp_order.h"

namespace cia402::ros_node {

/// When the newest position of them was on the wire; Time() where none is known.
Time newestFeedback(const std::vector<bus::JointState>& states);

/// Positions (rad or m), velocities (per s) and efforts (N m or N) of joints, in their order;
/// without a stamp.
/// @param joints their names, @param states those of a snapshot, in the same order
/// @param omit_unknown leaves out joints whose position is not known, and all velocities, or all
///   efforts, where one of those that are left is not: each list is as long as the names are, or
///   empty. Without it what is not known is NaN.
sensor_msgs::JointState jointStates(const std::vector<motion::Joint>& joints,
                                    const std::vector<bus::JointState>& states, bool omit_unknown);

/// Stamps of joint_states, each later than the one before.
class JointStateStamps {
 public:
  /// @param newest when the newest position of `states` was on the wire; any time where none is
  ///   known
  /// @param now both are ROS time
  /// @return the stamp of a message with these states: `newest`, or `now` where no position is
  ///   known, or where one got lost and nothing newer came for two seconds: what is known then is
  ///   of drives that tell changes only, and holds. None: there is nothing new to tell.
  [[nodiscard]] std::optional<ros::Time> next(const std::vector<bus::JointState>& states,
                                              const ros::Time& newest, const ros::Time& now);

 private:
  StampOrder order_;
  std::vector<bool> told_;  ///< which positions the last message had
};

}  // namespace cia402::ros_node
