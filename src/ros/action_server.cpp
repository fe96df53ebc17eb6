// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/action_server.h"

#include <actionlib_msgs/GoalStatusArray.h>
#include <cia402_driver/HomeAction.h>
#include <control_msgs/FollowJointTrajectoryAction.h>

#include <algorithm>
#include <iterator>

namespace cia402::ros_node {
namespace {

constexpr double kRemembered = 5.0;  // s: actionlib's; a goal that is sent twice runs once
constexpr unsigned int kQueue = 50;  // messages: actionlib's, of which the newest count
// Messages each of which counts: what clients send while the node gets no processor, and the
// results of all goals that end at once.
constexpr unsigned int kEachCounts = 1000;

}  // namespace

template <typename Action>
ActionServer<Action>::ActionServer(const ros::NodeHandle& node, const std::string& name,
                                   const Handler& on_goal, const Handler& on_cancel)
    : Base(on_goal, on_cancel, false), node_(node, name) {}

template <typename Action>
void ActionServer<Action>::tick() {
  forget();
  publishStatus();
}

template <typename Action>
void ActionServer<Action>::initialize() {
  result_ = node_.advertise<ActionResult>("result", kEachCounts);
  feedback_ = node_.advertise<ActionFeedback>("feedback", kQueue);
  status_ = node_.advertise<actionlib_msgs::GoalStatusArray>("status", kQueue, true);
  const boost::function<void(const ActionGoalConstPtr&)> on_goal =
      [this](const ActionGoalConstPtr& goal) {
        this->goalCallback(goal);
        remember(goal->goal_id.id);
      };
  const boost::function<void(const actionlib_msgs::GoalIDConstPtr&)> on_cancel =
      [this](const actionlib_msgs::GoalIDConstPtr& id) {
        this->cancelCallback(id);
        // A client whose clock is wrong must not cancel for ever what comes.
        this->last_cancel_ =
            std::min(this->last_cancel_, ros::Time::now() + ros::Duration(kRemembered));
        remember(id->id);
      };
  goal_ = node_.subscribe<ActionGoal>("goal", kEachCounts, on_goal);
  cancel_ = node_.subscribe<actionlib_msgs::GoalID>("cancel", kEachCounts, on_cancel);
}

template <typename Action>
void ActionServer<Action>::remember(const std::string& id) {
  for (auto& known : this->status_list_) {
    if (known.status_.goal_id.id != id || !known.handle_tracker_.expired()) continue;
    known.handle_destruction_time_ = ros::Time::now();
  }
}

template <typename Action>
void ActionServer<Action>::forget() {
  const ros::Time now = ros::Time::now();
  for (auto known = this->status_list_.begin(); known != this->status_list_.end();) {
    ros::Time& ended = known->handle_destruction_time_;
    if (ended > now) ended = now;  // the clock was set back
    const bool held = !known->handle_tracker_.expired();
    const bool due = now.toSec() - ended.toSec() > kRemembered;
    known = held || !due ? std::next(known) : this->status_list_.erase(known);
  }
}

template <typename Action>
void ActionServer<Action>::publishResult(const actionlib_msgs::GoalStatus& status,
                                         const Result& result) {
  ActionResult message;
  message.header.stamp = ros::Time::now();
  message.status = status;
  message.result = result;
  result_.publish(message);
  publishStatus();
}

template <typename Action>
void ActionServer<Action>::publishFeedback(const actionlib_msgs::GoalStatus& status,
                                           const Feedback& feedback) {
  ActionFeedback message;
  message.header.stamp = ros::Time::now();
  message.status = status;
  message.feedback = feedback;
  feedback_.publish(message);
}

template <typename Action>
void ActionServer<Action>::publishStatus() {
  actionlib_msgs::GoalStatusArray message;
  message.header.stamp = ros::Time::now();
  for (const auto& known : this->status_list_) message.status_list.push_back(known.status_);
  status_.publish(message);
}

template class ActionServer<control_msgs::FollowJointTrajectoryAction>;
template class ActionServer<cia402_driver::HomeAction>;

}  // namespace cia402::ros_node
