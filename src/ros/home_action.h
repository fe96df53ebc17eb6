// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cia402_driver/HomeAction.h>
#include <ros/node_handle.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bus/jobs/home_command.h"
#include "bus/mpsc_queue.h"
#include "bus/runner.h"
#include "config/robot.h"
#include "ros/action_server.h"

namespace cia402::ros_node {

/// The action ~home (cia402_driver/Home). A goal is accepted or rejected once the thread of the bus
/// has looked at it, which takes a cycle. It is SUCCEEDED where all axes were homed, PREEMPTED
/// where it was cancelled or an axis was stopped, else ABORTED; always once all its axes have
/// ended.
class HomeAction {
 public:
  /// @param wake called where update() has something to do; any thread, must not wait.
  /// Must outlive the thread of `runner`.
  HomeAction(ros::NodeHandle& private_node, bus::BusRunner& runner, std::function<void()> wake,
             const config::RobotConfig& robot);
  ~HomeAction();

  /// One thread, that of the node handle's callbacks: tells clients what has become of their goals.
  void update();
  /// A goal has not ended.
  bool busy() const { return !goals_.empty(); }
  /// The same thread, once a second: which goals there are; changes are told of at once.
  void publishStatus() { server_.tick(); }
  /// The same thread, regularly: what each axis does.
  void publishFeedback();

 private:
  using Server = ActionServer<cia402_driver::HomeAction>;
  /// Of one goal, from the thread of the bus.
  struct News {
    std::uint64_t id = 0;
    std::shared_ptr<const bus::ProcedureReport> answer;  ///< null: it has begun
  };
  struct Goal {
    Server::GoalHandle handle;
    std::vector<bus::HomingItem> plan;
    std::shared_ptr<bus::ProcedureProgress> progress;
  };

  void onGoal(Server::GoalHandle handle);
  void onCancel(const Server::GoalHandle& handle);
  void add(News news);
  void take(const News& news);
  void finish(Goal& goal, const bus::ProcedureReport& answer);

  bus::BusRunner& runner_;
  std::function<void()> wake_;
  const config::RobotConfig& robot_;
  std::map<std::uint64_t, Goal> goals_;  ///< that have not ended
  std::uint64_t last_id_ = 0;
  bus::MpscQueue<News> news_;
  Server server_;
};

/// What one axis of a goal does and waits for. @param axis as a cycle left it, at about the time of
/// the stage
std::string homingStep(bus::ProcedureStage stage, const bus::AxisSnapshot& axis);

/// s until the homing of an axis is given up at the latest; NaN where it does not run.
double homingTimeLeft(bus::ProcedureStage stage, const bus::AxisSnapshot& axis, Time now);

/// @param snapshot of the time of the answer
cia402_driver::HomeResult homeResult(const std::vector<bus::HomingItem>& plan,
                                     const bus::ProcedureReport& answer,
                                     const config::RobotConfig& robot,
                                     const bus::NetworkSnapshot& snapshot);

}  // namespace cia402::ros_node
