// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/frames.h"

#include <cmath>

#include "ros/clock_map.h"
#include "ros/frame_pose.h"

namespace cia402::ros_node {
namespace {

std::vector<geometry_msgs::TransformStamped> transformsOf(
    const std::vector<config::FrameConfig>& frames, const ros::Time& stamp) {
  std::vector<geometry_msgs::TransformStamped> messages;
  for (const config::FrameConfig& frame : frames) {
    messages.push_back(toTransform(frame, originOf(frame), stamp));
  }
  return messages;
}

}  // namespace

Frames::Frames(const bus::BusTime& time, const config::RobotConfig& robot) : time_(time) {
  if (!robot.publish_tf) return;
  const std::vector<motion::Joint> joints = robot.joints();
  for (const config::FrameConfig& frame : robot.frames) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (joints[i].name == frame.joint) moved_.push_back({&frame, i, joints[i].unit});
    }
  }
  if (!moved_.empty()) broadcaster_.emplace();
  if (robot.static_frames.empty()) return;
  static_broadcaster_.emplace();
  static_broadcaster_->sendTransform(transformsOf(robot.static_frames, ros::Time::now()));
}

void Frames::publish(const std::vector<bus::JointState>& joints) {
  if (!broadcaster_) return;
  std::vector<geometry_msgs::TransformStamped> messages;
  const ros::Time now = ros::Time::now();
  for (Moved& moved : moved_) {
    const bus::JointState& joint = joints[moved.joint];
    if (std::isnan(joint.position)) continue;
    const ros::Time stamp = toRos(time_, joint.stamp);
    if (!moved.order.next(stamp, now)) continue;
    const Eigen::Isometry3d pose = poseOf(*moved.frame, moved.unit, joint.position);
    messages.push_back(toTransform(*moved.frame, pose, stamp));
  }
  if (!messages.empty()) broadcaster_->sendTransform(messages);
}

}  // namespace cia402::ros_node
