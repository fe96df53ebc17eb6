// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/frames.h"

#include <tf2/LinearMath/Quaternion.h>
#include <tf2/LinearMath/Transform.h>

#include <cmath>

#include "ros/clock_map.h"

namespace cia402::ros_node {

geometry_msgs::TransformStamped jointTransform(const config::FrameConfig& frame, bool prismatic,
                                               double position, const ros::Time& stamp) {
  tf2::Quaternion turned;
  turned.setRPY(frame.rpy[0], frame.rpy[1], frame.rpy[2]);
  const tf2::Transform origin(turned, tf2::Vector3(frame.xyz[0], frame.xyz[1], frame.xyz[2]));
  const tf2::Vector3 axis = tf2::Vector3(frame.axis[0], frame.axis[1], frame.axis[2]).normalized();
  const tf2::Transform motion =
      prismatic ? tf2::Transform(tf2::Quaternion::getIdentity(), axis * position)
                : tf2::Transform(tf2::Quaternion(axis, position));
  const tf2::Transform result = origin * motion;
  geometry_msgs::TransformStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = frame.parent;
  message.child_frame_id = frame.child;
  message.transform.translation.x = result.getOrigin().x();
  message.transform.translation.y = result.getOrigin().y();
  message.transform.translation.z = result.getOrigin().z();
  message.transform.rotation.x = result.getRotation().x();
  message.transform.rotation.y = result.getRotation().y();
  message.transform.rotation.z = result.getRotation().z();
  message.transform.rotation.w = result.getRotation().w();
  return message;
}

Frames::Frames(bus::BusRunner& runner, const config::RobotConfig& robot)
    : runner_(runner), frames_(robot.frames), joints_(bus::jointsOf(robot)) {}

void Frames::publish() {
  if (frames_.empty()) return;
  const bus::NetworkSnapshot snapshot = runner_.snapshot();
  std::vector<geometry_msgs::TransformStamped> messages;
  for (const config::FrameConfig& frame : frames_) {
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const bus::JointState& joint = snapshot.joints[i];
      if (joints_[i].name != frame.joint || std::isnan(joint.position)) continue;
      const bool prismatic = joints_[i].unit == motion::JointUnit::metre;
      const ros::Time stamp = toRos(runner_.time(), joint.stamp);
      messages.push_back(jointTransform(frame, prismatic, joint.position, stamp));
    }
  }
  if (!messages.empty()) broadcaster_.sendTransform(messages);
}

}  // namespace cia402::ros_node
