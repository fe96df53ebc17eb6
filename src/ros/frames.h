// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tf2_ros/transform_broadcaster.h>

#include <vector>

#include "bus/joint.h"
#include "bus/runner.h"
#include "config/robot.h"

namespace cia402::ros_node {

/// Transform of a joint's child frame in its parent frame at a joint position (rad or m): the
/// origin, then the turn about or the shift along the axis, as URDF defines joints.
geometry_msgs::TransformStamped jointTransform(const config::FrameConfig& frame, bool prismatic,
                                               double position, const ros::Time& stamp);

/// Publishes the frames of joints that have a `frame` section to /tf. A joint whose position is not
/// known sends nothing.
class Frames {
 public:
  Frames(bus::BusRunner& runner, const config::RobotConfig& robot);

  void publish();

 private:
  bus::BusRunner& runner_;
  const std::vector<config::FrameConfig>& frames_;
  std::vector<motion::Joint> joints_;
  tf2_ros::TransformBroadcaster broadcaster_;
};

}  // namespace cia402::ros_node
