// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <geometry_msgs/TransformStamped.h>

#include <Eigen/Geometry>

#include "config/robot.h"
#include "motion/joint.h"

namespace cia402::ros_node {

/// Where a frame that stands still is in its parent; of one that a joint moves, where it is with
/// the joint at 0: shifted by `xyz`, then turned by `rpy` about the parent's x, y and z, in this
/// order.
Eigen::Isometry3d originOf(const config::FrameConfig& frame);

/// Where the frame that a joint moves is in its parent, as URDF has it: its origin, then the turn
/// about its axis, or the shift along it.
/// @param unit of the joint: in radian it turns, in metre it shifts
/// @param position of the joint, rad (any number of turns) or m; finite
Eigen::Isometry3d poseOf(const config::FrameConfig& frame, motion::JointUnit unit, double position);

/// The same for tf. @param stamp when the frame was there
geometry_msgs::TransformStamped toTransform(const config::FrameConfig& frame,
                                            const Eigen::Isometry3d& pose, const ros::Time& stamp);

}  // namespace cia402::ros_node
