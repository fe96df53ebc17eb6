// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/command_topics.h"

#include <control_msgs/FollowJointTrajectoryResult.h>

#include <boost/function.hpp>
#include <utility>

#include "ros/clock_map.h"

namespace cia402::ros_node {
namespace {

constexpr std::size_t kResults = 256;  // more in one go are lost; the log has them

}  // namespace

bus::TrajectoryCommand trajectoryCommand(const std::string& group,
                                         const trajectory_msgs::JointTrajectory& message,
                                         const bus::BusTime& time) {
  bus::TrajectoryCommand command;
  command.group = group;
  command.joints = message.joint_names;
  for (const trajectory_msgs::JointTrajectoryPoint& point : message.points) {
    command.points.push_back({point.positions, point.velocities, point.accelerations,
                              Duration(point.time_from_start.toNSec())});
  }
  if (!message.header.stamp.isZero()) command.start_time = fromRos(time, message.header.stamp);
  return command;
}

CommandTopics::CommandTopics(ros::NodeHandle& private_node, bus::BusRunner& runner,
                             bus::ReplyLog& replies, std::function<void()> wake,
                             const config::RobotConfig& robot)
    : runner_(runner), replies_(replies), wake_(std::move(wake)), results_(kResults) {
  for (std::size_t i = 0; i < robot.axes.size(); ++i) {
    const boost::function<void(const std_msgs::Float64&)> callback =
        [this, i](const std_msgs::Float64& message) { onSetpoint(i, message); };
    subscribers_.push_back(private_node.subscribe<const std_msgs::Float64&>(
        robot.axes[i].name + "/command", 1, callback, ros::VoidConstPtr(),
        ros::TransportHints().tcpNoDelay()));
  }
  for (std::size_t i = 0; i < robot.groups.size(); ++i) {
    const std::string& name = robot.groups[i].name;
    groups_.push_back(name);
    const boost::function<void(const trajectory_msgs::JointTrajectory&)> callback =
        [this, i](const trajectory_msgs::JointTrajectory& message) { onTrajectory(i, message); };
    const boost::function<void(const std_msgs::Float64MultiArray&)> stream =
        [this, i](const std_msgs::Float64MultiArray& message) { onSetpoints(i, message); };
    subscribers_.push_back(private_node.subscribe<const std_msgs::Float64MultiArray&>(
        name + "/commands", 1, stream, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
    subscribers_.push_back(private_node.subscribe<const trajectory_msgs::JointTrajectory&>(
        name + "/command", 1, callback));
    result_pubs_.push_back(private_node.advertise<control_msgs::FollowJointTrajectoryResult>(
        name + "/command_result", 10));
  }
}

void CommandTopics::onSetpoint(std::size_t axis, const std_msgs::Float64& message) {
  runner_.post(bus::Command(bus::SetpointCommand{axis, message.data, runner_.time().now()},
                            replies_.toSetpoint(axis)));
}

void CommandTopics::onSetpoints(std::size_t group, const std_msgs::Float64MultiArray& message) {
  runner_.post(bus::Command(bus::GroupSetpointsCommand{group, message.data, runner_.time().now()},
                            replies_.toGroupSetpoints(group)));
}

void CommandTopics::onTrajectory(std::size_t group,
                                 const trajectory_msgs::JointTrajectory& message) {
  bus::TrajectoryCommand command = trajectoryCommand(groups_[group], message, runner_.time());
  command.streamed = true;
  command.ended = [this, group](const bus::TrajectoryOutcome& outcome) {
    if (outcome.end == bus::TrajectoryEnd::replaced) return;  // a stream's are, each of them
    add(group, outcome.code, outcome.message);
  };
  const bus::Reply<bus::TrajectoryAnswer> log = replies_.toTrajectory();
  runner_.post(
      bus::Command(std::move(command), [this, group, log](const bus::TrajectoryAnswer& answer) {
        log(answer);
        if (!answer.success) add(group, answer.code, answer.message);
      }));
}

void CommandTopics::add(std::size_t group, motion::TrajectoryErrorCode code,
                        const std::string& text) {
  Result result;
  result.group = group;
  result.code = code;
  result.text.assign(text);
  (void)results_.push(std::move(result));
  wake_();
}

void CommandTopics::update() {
  for (Result result; results_.pop(result);) {
    control_msgs::FollowJointTrajectoryResult message;
    message.error_code = static_cast<std::int32_t>(result.code);
    message.error_string = result.text.str();
    result_pubs_[result.group].publish(message);
  }
}

}  // namespace cia402::ros_node
