// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/frame_pose.h"

namespace cia402::ros_node {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

Vector3d vectorOf(const double (&numbers)[3]) { return {numbers[0], numbers[1], numbers[2]}; }

}  // namespace

Eigen::Isometry3d originOf(const config::FrameConfig& frame) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(vectorOf(frame.xyz));
  pose.rotate(AngleAxisd(frame.rpy[2], Vector3d::UnitZ()) *
              AngleAxisd(frame.rpy[1], Vector3d::UnitY()) *
              AngleAxisd(frame.rpy[0], Vector3d::UnitX()));
  return pose;
}

Eigen::Isometry3d poseOf(const config::FrameConfig& frame, motion::JointUnit unit,
                         double position) {
  const Vector3d axis = vectorOf(frame.axis).normalized();
  Eigen::Isometry3d pose = originOf(frame);
  if (unit == motion::JointUnit::metre) {
    pose.translate(axis * position);
  } else {
    pose.rotate(AngleAxisd(position, axis));
  }
  return pose;
}

geometry_msgs::TransformStamped toTransform(const config::FrameConfig& frame,
                                            const Eigen::Isometry3d& pose, const ros::Time& stamp) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond(pose.linear()).normalized();
  geometry_msgs::TransformStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = frame.parent;
  message.child_frame_id = frame.child;
  message.transform.translation.x = pose.translation().x();
  message.transform.translation.y = pose.translation().y();
  message.transform.translation.z = pose.translation().z();
  message.transform.rotation.x = turn.x();
  message.transform.rotation.y = turn.y();
  message.transform.rotation.z = turn.z();
  message.transform.rotation.w = turn.w();
  return message;
}

}  // namespace cia402::ros_node
