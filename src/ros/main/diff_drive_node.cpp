// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A base on wheels that a bus_node drives: an example of who sits on top of it. What it does is in
// DiffDriveBase; here is what it hears and says.
#include <control_msgs/JointTrajectoryControllerState.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64MultiArray.h>
#include <tf2_ros/transform_broadcaster.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bus/real_clock.h"
#include "common/text.h"
#include "ros/command_line.h"
#include "ros/diff_drive_base.h"
#include "ros/diff_drive_parameters.h"
#include "ros/stamp_order.h"

namespace {

using namespace cia402;  // NOLINT: a main file
using ros_node::DiffDriveParameters;

constexpr char kHelp[] = R"(Usage: diff_drive_node [name:=value...]

Drives a base on wheels: takes cmd_vel, commands the wheels through a group of a bus_node, tells
odom and tf. An example; try it with simulated drives:

  roslaunch cia402_driver diff_drive.launch
  rosservice call /bus/enable
  rostopic pub -r 10 /cmd_vel geometry_msgs/Twist '{linear: {x: 0.2}, angular: {z: 0.3}}'

Its parameters: docs/diff_drive.md.
)";

constexpr double kRefusalInterval = 1.0;  // s

class DiffDriveNode {
 public:
  DiffDriveNode(ros::NodeHandle& node, DiffDriveParameters parameters)
      : parameters_(std::move(parameters)), base_(parameters_.base) {
    wheels_ = parameters_.base.left;
    wheels_.insert(wheels_.end(), parameters_.base.right.begin(), parameters_.base.right.end());
    odom_pub_ = node.advertise<nav_msgs::Odometry>("odom", 10);
    wheel_pub_ = node.advertise<std_msgs::Float64MultiArray>(parameters_.group + "/commands", 1);
    const ros::TransportHints at_once = ros::TransportHints().tcpNoDelay();
    group_sub_ =
        node.subscribe(parameters_.group + "/state", 1, &DiffDriveNode::onGroup, this, at_once);
    joints_sub_ = node.subscribe("joint_states", 10, &DiffDriveNode::onJoints, this, at_once);
    command_sub_ = node.subscribe("cmd_vel", 1, &DiffDriveNode::onCommand, this, at_once);
    timer_ = node.createSteadyTimer(ros::WallDuration(1.0 / parameters_.rate),
                                    [this](const ros::SteadyTimerEvent&) { drive(); });
  }

 private:
  void onCommand(const geometry_msgs::Twist& message) {
    const std::string refused =
        base_.command({message.linear.x, message.angular.z}, bus::realNow());
    if (!refused.empty()) ROS_WARN_STREAM_THROTTLE(kRefusalInterval, refused);
    if (message.linear.y != 0.0) {
      ROS_WARN_STREAM_THROTTLE(kRefusalInterval,
                               "cmd_vel: linear.y is left out, wheels do not go sideways");
    }
  }

  /// The order of the group's joints, which is asked for once.
  void onGroup(const control_msgs::JointTrajectoryControllerState& message) {
    std::vector<std::size_t> order;
    for (const std::string& name : message.joint_names) {
      const auto wheel = std::find(wheels_.begin(), wheels_.end(), name);
      if (wheel == wheels_.end()) break;
      order.push_back(static_cast<std::size_t>(wheel - wheels_.begin()));
    }
    if (order.size() != wheels_.size() || message.joint_names.size() != wheels_.size()) {
      ROS_ERROR_STREAM_THROTTLE(10.0, parameters_.group
                                          << " has the joints " << joined(message.joint_names, ", ")
                                          << ", and not just the wheels " << joined(wheels_, ", ")
                                          << ": nothing is commanded");
      return;
    }
    order_ = std::move(order);
    group_sub_.shutdown();
  }

  void onJoints(const sensor_msgs::JointState& message) {
    std::vector<double> positions(wheels_.size(), std::numeric_limits<double>::quiet_NaN());
    bool any = false;
    for (std::size_t i = 0; i < message.name.size() && i < message.position.size(); ++i) {
      const auto wheel = std::find(wheels_.begin(), wheels_.end(), message.name[i]);
      if (wheel == wheels_.end()) continue;
      positions[static_cast<std::size_t>(wheel - wheels_.begin())] = message.position[i];
      any = true;
    }
    if (!any || !stamps_.next(message.header.stamp, ros::Time::now())) return;  // of others, or old
    if (base_.measured(positions, bus::realNow())) tellOdometry(message.header.stamp);
    tellNews();
  }

  void drive() {
    const auto speeds = base_.step(bus::realNow());
    tellNews();
    if (!speeds || order_.empty()) return;
    std_msgs::Float64MultiArray message;
    const std::size_t left = parameters_.base.left.size();
    for (const std::size_t wheel : order_) {
      message.data.push_back(wheel < left ? speeds->left : speeds->right);
    }
    wheel_pub_.publish(message);
  }

  void tellNews() {
    for (const std::string& news : base_.takeNews()) ROS_WARN_STREAM(news);
  }

  void tellOdometry(const ros::Time& stamp) {
    const auto& pose = base_.odometry().pose();
    nav_msgs::Odometry message;
    message.header.stamp = stamp;
    message.header.frame_id = parameters_.odom_frame;
    message.child_frame_id = parameters_.base_frame;
    message.pose.pose.position.x = pose.position.x();
    message.pose.pose.position.y = pose.position.y();
    message.pose.pose.orientation.z = std::sin(pose.heading / 2.0);
    message.pose.pose.orientation.w = std::cos(pose.heading / 2.0);
    message.twist.twist.linear.x = base_.velocity().linear;
    message.twist.twist.angular.z = base_.velocity().angular;
    for (std::size_t i = 0; i < 6; ++i) {
      message.pose.covariance[7 * i] = parameters_.pose_covariance[i];
      message.twist.covariance[7 * i] = parameters_.twist_covariance[i];
    }
    odom_pub_.publish(message);
    if (!parameters_.publish_tf) return;
    geometry_msgs::TransformStamped transform;
    transform.header = message.header;
    transform.child_frame_id = message.child_frame_id;
    transform.transform.translation.x = message.pose.pose.position.x;
    transform.transform.translation.y = message.pose.pose.position.y;
    transform.transform.rotation = message.pose.pose.orientation;
    tf_.sendTransform(transform);
  }

  DiffDriveParameters parameters_;
  ros_node::DiffDriveBase base_;
  std::vector<std::string> wheels_;  ///< left ones, then right ones
  std::vector<std::size_t> order_;   ///< in which the group has them; empty: not known yet
  ros_node::StampOrder stamps_;
  tf2_ros::TransformBroadcaster tf_;
  ros::Publisher odom_pub_, wheel_pub_;
  ros::Subscriber group_sub_, joints_sub_, command_sub_;
  ros::SteadyTimer timer_;
};

}  // namespace

int main(int argc, char** argv) {
  if (const auto status = ros_node::readCommandLine(argc, argv, kHelp)) return *status;
  ros::init(argc, argv, "diff_drive");
  ros::NodeHandle node;  // waits for the ROS master
  ros::NodeHandle private_node("~");
  Problems problems;
  DiffDriveParameters parameters = ros_node::readDiffDrive(private_node, problems);
  if (!problems.empty()) {
    ROS_FATAL_STREAM("the parameters are wrong:\n" << problems.text());
    return 1;
  }
  DiffDriveNode drive(node, std::move(parameters));
  ros::spin();
  return 0;
}
