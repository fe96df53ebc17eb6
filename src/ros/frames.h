// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <cstddef>
#include <optional>
#include <vector>

#include "bus/bus_time.h"
#include "bus/snapshot.h"
#include "config/robot.h"
#include "motion/joint.h"
#include "ros/stamp_order.h"

namespace cia402::ros_node {

/// Tells tf where the frames of a robot are, if it is to (`publish_tf`): those that stand still
/// once, to /tf_static, those of joints to /tf.
class Frames {
 public:
  /// @param robot must outlive it
  Frames(const bus::BusTime& time, const config::RobotConfig& robot);

  /// Sends the frames of those joints whose position is known, each with the time of its feedback
  /// as its stamp, and where that is newer than what was sent before.
  /// @param joints those of a snapshot
  void publish(const std::vector<bus::JointState>& joints);

 private:
  /// A frame, and the joint that moves it.
  struct Moved {
    const config::FrameConfig* frame;
    std::size_t joint;  ///< index in the snapshot
    motion::JointUnit unit;
    StampOrder order{};
  };

  const bus::BusTime& time_;
  std::vector<Moved> moved_;
  std::optional<tf2_ros::TransformBroadcaster> broadcaster_;
  std::optional<tf2_ros::StaticTransformBroadcaster> static_broadcaster_;
};

}  // namespace cia402::ros_node
