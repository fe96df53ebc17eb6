// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <control_msgs/FollowJointTrajectoryAction.h>
#include <ros/node_handle.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bus/command.h"
#include "bus/fixed_text.h"
#include "bus/mpsc_queue.h"
#include "bus/runner.h"
#include "config/robot.h"
#include "motion/joint.h"
#include "ros/action_server.h"

namespace cia402::ros_node {

/// The actions ~<group>/follow_joint_trajectory (control_msgs/FollowJointTrajectory). A goal is
/// accepted or rejected once the thread of the bus has looked at it, which takes a cycle, and ends
/// as bus::TrajectoryOutcome says: reached is SUCCEEDED, replaced and stopped PREEMPTED, failed
/// ABORTED. A cancelled goal ends when its joints stand.
class TrajectoryActions {
 public:
  /// @param wake called where update() has something to do; any thread, must not wait.
  /// Must outlive the thread of `runner`.
  TrajectoryActions(ros::NodeHandle& private_node, bus::BusRunner& runner,
                    std::function<void()> wake, const config::RobotConfig& robot);
  ~TrajectoryActions();

  /// One thread, that of the node handle's callbacks: tells clients what has become of their goals.
  void update();
  /// A goal has not ended.
  bool busy() const { return !goals_.empty(); }
  /// The same thread, once a second: which goals there are; changes are told of at once.
  void publishStatus();
  /// The same thread, regularly: where the joints of each goal are to be, and are.
  void publishFeedback();

 private:
  using Server = ActionServer<control_msgs::FollowJointTrajectoryAction>;
  /// Of one goal, from the thread of the bus.
  struct News {
    enum class Kind : std::uint8_t { answered, ended };
    std::uint64_t id = 0;
    Kind kind = Kind::answered;
    bool accepted = false;
    motion::TrajectoryErrorCode code = motion::TrajectoryErrorCode::successful;
    bus::TrajectoryEnd end = bus::TrajectoryEnd::refused;
    bus::FixedText<512> text;
  };
  struct Goal {
    std::size_t group = 0;
    Server::GoalHandle handle;
    bool stops = false;  ///< it has no points
  };

  void onGoal(std::size_t group, Server::GoalHandle handle);
  void onCancel(std::size_t group, const Server::GoalHandle& handle);
  void add(const News& news);
  void take(const News& news);
  static void finish(Goal& goal, const News& news);

  bus::BusRunner& runner_;
  std::function<void()> wake_;
  const config::RobotConfig& robot_;
  const std::vector<motion::Joint> joints_;       ///< in the order of the snapshots
  std::vector<std::unique_ptr<Server>> servers_;  ///< of each group
  std::map<std::uint64_t, Goal> goals_;           ///< that have not ended
  std::uint64_t last_id_ = 0;
  bus::MpscQueue<News> news_;
};

/// The tolerances that a goal states for a group: positive ones count, negative ones switch off
/// what the configuration has, 0 leaves it; other joints are nobody's business.
bus::TrajectoryTolerances tolerancesOf(const control_msgs::FollowJointTrajectoryGoal& goal,
                                       const config::GroupConfig& group);

}  // namespace cia402::ros_node
