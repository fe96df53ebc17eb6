// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/home_action.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace cia402::ros_node {
namespace {

using bus::ProcedureStage;

constexpr std::size_t kMostHomings = 64;               // goals that have not ended
constexpr std::size_t kHomingNews = 4 * kMostHomings;  // two of each goal, and room to be late

/// The procedure that the snapshot shows is the one that homes.
bool showsHoming(ProcedureStage stage, const bus::AxisSnapshot& axis) {
  return stage == ProcedureStage::running && axis.procedure_running &&
         axis.procedure == drive::ProcedureKind::home;
}

}  // namespace

std::string homingStep(ProcedureStage stage, const bus::AxisSnapshot& axis) {
  switch (stage) {
    case ProcedureStage::waiting:
      return "waits for its turn";
    case ProcedureStage::running:
    case ProcedureStage::restoring:
      break;
    case ProcedureStage::succeeded:
      return "homed";
    case ProcedureStage::failed:
      return "has ended without success";
  }
  if (!showsHoming(stage, axis) || axis.words.step.empty()) return "begins or ends";
  std::string text = axis.words.step.str();
  if (!axis.words.waiting_for.empty()) text += "; waits for " + axis.words.waiting_for.str();
  return text;
}

double homingTimeLeft(ProcedureStage stage, const bus::AxisSnapshot& axis, Time now) {
  if (!showsHoming(stage, axis)) return std::numeric_limits<double>::quiet_NaN();
  return std::max(0.0, toSeconds(axis.procedure_deadline - now));
}

cia402_driver::HomeResult homeResult(const std::vector<bus::HomingItem>& plan,
                                     const bus::ProcedureReport& answer,
                                     const config::RobotConfig& robot,
                                     const bus::NetworkSnapshot& snapshot) {
  cia402_driver::HomeResult result;
  result.success = answer.success;
  result.message = answer.message;
  for (const bus::HomingItem& item : plan) {
    const std::string& name = robot.axes[item.axis].name;
    const auto told = std::find_if(
        answer.axes.begin(), answer.axes.end(),
        [&](const bus::ProcedureReport::Axis& axis) { return axis.number == item.axis; });
    const bool known = told != answer.axes.end();
    result.axes.push_back(name);
    result.homed.push_back(known ? told->homed : snapshot.axes[item.axis].state.homed);
    result.messages.push_back(known ? told->message : name + ": was not begun");
  }
  return result;
}

HomeAction::HomeAction(ros::NodeHandle& private_node, bus::BusRunner& runner,
                       std::function<void()> wake, const config::RobotConfig& robot)
    : runner_(runner),
      wake_(std::move(wake)),
      robot_(robot),
      news_(kHomingNews),
      server_(
          private_node, "home", [this](const Server::GoalHandle& handle) { onGoal(handle); },
          [this](const Server::GoalHandle& handle) { onCancel(handle); }) {
  server_.start();
}

HomeAction::~HomeAction() {
  bus::ProcedureReport answer;
  answer.message = "the driver has ended";
  for (auto& [id, goal] : goals_) {
    if (isPending(goal.handle)) goal.handle.setAccepted();
    finish(goal, answer);
  }
}

void HomeAction::onGoal(Server::GoalHandle handle) {
  const auto wanted = handle.getGoal();
  auto plan = bus::homingPlan(robot_, wanted->axes, wanted->order);
  if (plan && goals_.size() >= kMostHomings) {
    plan =
        Error{std::to_string(kMostHomings) + " goals have not ended yet; wait for their results"};
  }
  if (!plan) {
    cia402_driver::HomeResult result;
    result.message = plan.error().message;
    return handle.setRejected(result, result.message);
  }
  bus::HomeCommand command;
  const std::uint64_t id = command.id = ++last_id_;
  command.plan = *plan;
  command.progress = std::make_shared<bus::ProcedureProgress>(robot_.axes.size());
  command.begun = [this, id] { add({id, nullptr}); };
  goals_[id] = {handle, *plan, command.progress};
  runner_.post(bus::Command(std::move(command), [this, id](const bus::ProcedureReport& answer) {
    add({id, std::make_shared<const bus::ProcedureReport>(answer)});
  }));
}

void HomeAction::onCancel(const Server::GoalHandle& handle) {
  for (const auto& [id, goal] : goals_) {
    if (goal.handle == handle) runner_.post(bus::Command(bus::CancelHomeCommand{id}));
  }
}

/// Each goal has two, so that there is room.
void HomeAction::add(News news) {
  (void)news_.push(std::move(news));
  wake_();
}

void HomeAction::update() {
  for (News news; news_.pop(news);) take(news);
}

void HomeAction::take(const News& news) {
  const auto found = goals_.find(news.id);
  if (found == goals_.end()) return;
  if (!news.answer) {
    if (isPending(found->second.handle)) found->second.handle.setAccepted();
    return;
  }
  finish(found->second, *news.answer);
  goals_.erase(found);
}

void HomeAction::finish(Goal& goal, const bus::ProcedureReport& answer) {
  const auto result = homeResult(goal.plan, answer, robot_, runner_.snapshot());
  Server::GoalHandle& handle = goal.handle;
  if (isPending(handle) && !answer.success) return handle.setRejected(result, answer.message);
  if (isPending(handle)) handle.setAccepted();
  if (answer.success) return handle.setSucceeded(result, answer.message);
  if (answer.stopped) return handle.setCanceled(result, answer.message);
  handle.setAborted(result, answer.message);
}

void HomeAction::publishFeedback() {
  const bus::NetworkSnapshot snapshot = runner_.snapshot();
  for (auto& [id, goal] : goals_) {
    if (isPending(goal.handle)) continue;
    cia402_driver::HomeFeedback feedback;
    for (const bus::HomingItem& item : goal.plan) {
      const bus::AxisSnapshot& axis = snapshot.axes[item.axis];
      const ProcedureStage stage = goal.progress->of(item.axis);
      feedback.axes.push_back(robot_.axes[item.axis].name);
      feedback.steps.push_back(homingStep(stage, axis));
      feedback.positions.push_back(axis.state.position);
      feedback.time_left.push_back(homingTimeLeft(stage, axis, snapshot.now));
    }
    goal.handle.publishFeedback(feedback);
  }
}

}  // namespace cia402::ros_node
