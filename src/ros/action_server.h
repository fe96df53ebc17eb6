// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <actionlib/server/action_server_base.h>
#include <actionlib_msgs/GoalID.h>
#include <actionlib_msgs/GoalStatus.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>

#include <string>

namespace cia402::ros_node {

/// The wire of an action, its goals kept by actionlib.
/// actionlib::ActionServer has a wire, too, but forgets goals while it walks over them (a goal that
/// was cancelled in advance under an old stamp makes it read freed memory), never forgets what
/// was cancelled under stamp 0, throws at stamps near 2^32 s, and cancels all goals until then:
/// a message must do none of that.
/// All of it runs in the thread of the node handle's callbacks.
/// @tparam Action the message that is named after the action; those that there are: see the source
template <typename Action>
class ActionServer final : public actionlib::ActionServerBase<Action> {
 public:
  ACTION_DEFINITION(Action)  // the types of its messages
  using Base = actionlib::ActionServerBase<Action>;
  using GoalHandle = typename Base::GoalHandle;
  using Handler = boost::function<void(GoalHandle)>;

  /// @param name of the action, in the namespace of `node`; its topics are <name>/goal, cancel,
  /// status, feedback and result
  ActionServer(const ros::NodeHandle& node, const std::string& name, const Handler& on_goal,
               const Handler& on_cancel);

  /// Forgets goals that ended 5 s ago or more, and tells the status of the others. Regularly;
  /// changes are told of at once.
  void tick();

 private:
  void initialize() override;
  void publishResult(const actionlib_msgs::GoalStatus& status, const Result& result) override;
  void publishFeedback(const actionlib_msgs::GoalStatus& status, const Feedback& feedback) override;
  void publishStatus() override;
  /// The goal of that id, where it has ended or has not come yet, is known for 5 s from now on.
  void remember(const std::string& id);
  void forget();

  ros::NodeHandle node_;
  ros::Publisher status_;
  ros::Publisher feedback_;
  ros::Publisher result_;
  ros::Subscriber goal_;
  ros::Subscriber cancel_;
};

/// Nobody has accepted or rejected the goal yet.
template <typename GoalHandle>
bool isPending(const GoalHandle& goal) {
  const auto status = goal.getGoalStatus().status;
  return status == actionlib_msgs::GoalStatus::PENDING ||
         status == actionlib_msgs::GoalStatus::RECALLING;
}

}  // namespace cia402::ros_node
