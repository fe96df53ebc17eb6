// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/trajectory_actions.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "ros/command_topics.h"
#include "ros/group_message.h"

namespace cia402::ros_node {
namespace {

using motion::TrajectoryErrorCode;

constexpr std::size_t kMostGoals = 64;         // that have not ended
constexpr std::size_t kNews = 4 * kMostGoals;  // two of each goal, and room to be late

control_msgs::FollowJointTrajectoryResult resultOf(TrajectoryErrorCode code,
                                                   const std::string& text) {
  control_msgs::FollowJointTrajectoryResult result;
  result.error_code = static_cast<std::int32_t>(code);
  result.error_string = text;
  return result;
}

/// 0: as it is; below 0: none.
void state(double in_goal, std::optional<double>& tolerance) {
  if (in_goal != 0.0) tolerance = std::max(in_goal, 0.0);
}

}  // namespace

bus::TrajectoryTolerances tolerancesOf(const control_msgs::FollowJointTrajectoryGoal& goal,
                                       const config::GroupConfig& group) {
  bus::TrajectoryTolerances tolerances;
  for (const std::string& joint : group.joints) {
    for (const control_msgs::JointTolerance& path : goal.path_tolerance) {
      if (path.name == joint) state(path.position, tolerances.joints[joint].trajectory);
    }
    for (const control_msgs::JointTolerance& end : goal.goal_tolerance) {
      if (end.name == joint) state(end.position, tolerances.joints[joint].goal);
    }
  }
  const double seconds = goal.goal_time_tolerance.toSec();
  if (seconds != 0.0) tolerances.goal_time = std::max(seconds, 0.0);
  return tolerances;
}

TrajectoryActions::TrajectoryActions(ros::NodeHandle& private_node, bus::BusRunner& runner,
                                     std::function<void()> wake, const config::RobotConfig& robot)
    : runner_(runner),
      wake_(std::move(wake)),
      robot_(robot),
      joints_(robot.joints()),
      news_(kNews) {
  for (std::size_t group = 0; group < robot.groups.size(); ++group) {
    servers_.push_back(std::make_unique<Server>(
        private_node, robot.groups[group].name + "/follow_joint_trajectory",
        [this, group](const Server::GoalHandle& handle) { onGoal(group, handle); },
        [this, group](const Server::GoalHandle& handle) { onCancel(group, handle); }));
    servers_.back()->start();
  }
}

TrajectoryActions::~TrajectoryActions() {
  News news;
  news.end = bus::TrajectoryEnd::failed;
  news.code = TrajectoryErrorCode::path_tolerance_violated;
  news.text.assign("the driver has ended");
  for (auto& [id, goal] : goals_) finish(goal, news);
}

void TrajectoryActions::onGoal(std::size_t group, Server::GoalHandle handle) {
  const config::GroupConfig& config = robot_.groups[group];
  const auto goal = handle.getGoal();
  const auto reject = [&](TrajectoryErrorCode code, const std::string& why) {
    const std::string text = config.name + ": " + why;
    handle.setRejected(resultOf(code, text), text);
  };
  if (goal->trajectory.joint_names.empty()) {
    return reject(TrajectoryErrorCode::invalid_joints, "the goal names no joints");
  }
  if (goals_.size() >= kMostGoals) {
    return reject(TrajectoryErrorCode::invalid_goal,
                  std::to_string(kMostGoals) + " goals have not ended yet; wait for their results");
  }
  bus::TrajectoryCommand command = trajectoryCommand(config.name, goal->trajectory, runner_.time());
  const std::uint64_t id = command.id = ++last_id_;
  command.tolerances = tolerancesOf(*goal, config);
  command.ended = [this, id](const bus::TrajectoryOutcome& outcome) {
    News news;
    news.id = id;
    news.kind = News::Kind::ended;
    news.code = outcome.code;
    news.end = outcome.end;
    news.text.assign(outcome.message);
    add(news);
  };
  goals_[id] = {group, handle, command.points.empty()};
  runner_.post(bus::Command(std::move(command), [this, id](const bus::TrajectoryAnswer& answer) {
    News news;
    news.id = id;
    news.accepted = answer.success;
    news.code = answer.code;
    news.text.assign(answer.message);
    add(news);
  }));
}

void TrajectoryActions::onCancel(std::size_t group, const Server::GoalHandle& handle) {
  for (const auto& [id, goal] : goals_) {
    if (!(goal.handle == handle)) continue;
    runner_.post(bus::Command(bus::CancelCommand{robot_.groups[group].name, id}));
  }
}

/// Each goal has two, so that there is room.
void TrajectoryActions::add(const News& news) {
  (void)news_.push(News(news));
  wake_();
}

void TrajectoryActions::update() {
  for (News news; news_.pop(news);) take(news);
}

void TrajectoryActions::take(const News& news) {
  const auto found = goals_.find(news.id);
  if (found == goals_.end()) return;
  Goal& goal = found->second;
  if (news.kind == News::Kind::answered && news.accepted) {
    if (isPending(goal.handle)) goal.handle.setAccepted(news.text.str());
    return;
  }
  finish(goal, news);
  goals_.erase(found);
}

void TrajectoryActions::finish(Goal& goal, const News& news) {
  Server::GoalHandle& handle = goal.handle;
  const std::string text = news.text.str();
  const auto result = resultOf(news.code, text);
  if (news.kind == News::Kind::answered && news.end == bus::TrajectoryEnd::refused) {
    return handle.setRejected(result, text);
  }
  if (isPending(handle)) handle.setAccepted();
  switch (news.end) {
    case bus::TrajectoryEnd::reached:
      return handle.setSucceeded(result, text);
    case bus::TrajectoryEnd::stopped:
      if (goal.stops) return handle.setSucceeded(result, text);
      return handle.setCanceled(result, text);
    case bus::TrajectoryEnd::replaced:
      return handle.setCanceled(result, text);
    case bus::TrajectoryEnd::refused:
    case bus::TrajectoryEnd::failed:
      return handle.setAborted(result, text);
  }
}

void TrajectoryActions::publishStatus() {
  for (const auto& server : servers_) server->tick();
}

void TrajectoryActions::publishFeedback() {
  const bus::NetworkSnapshot snapshot = runner_.snapshot();
  for (auto& [id, goal] : goals_) {
    if (isPending(goal.handle)) continue;
    control_msgs::FollowJointTrajectoryFeedback feedback;
    feedback.header.stamp = ros::Time::now();
    addGroup(robot_.groups[goal.group], joints_, snapshot, feedback);
    goal.handle.publishFeedback(feedback);
  }
}

}  // namespace cia402::ros_node
