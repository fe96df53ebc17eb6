// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/home_command.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "bus/axis_cycle.h"
#include "bus/jobs/procedure_job.h"
#include "config/robot.h"

namespace cia402::bus {
namespace {

/// Gathers what is to be homed; the first mistake ends it.
class HomingPlan {
 public:
  explicit HomingPlan(const config::RobotConfig& robot) : robot_(robot) {}

  void addAll() {
    for (std::size_t axis = 0; axis < robot_.axes.size(); ++axis) {
      if (robot_.axes[axis].homing) add(axis, {}, false);
    }
    if (items_.empty()) problem_ = "nothing to do: no axis has a `homing` section";
  }
  void add(const std::string& name, std::optional<int> order) {
    const auto axis = indexWhere([&](const drive::AxisConfig& of) { return of.name == name; });
    if (!axis) return addGroup(name, order);
    if (robot_.axes[*axis].homing) return addSides(*axis, order);
    problem_ = drive::jointName(robot_.axes[*axis]) +
               " has no `homing` section; set_position says where it stands";
  }
  bool failed() const { return !problem_.empty(); }
  Result<std::vector<HomingItem>> take() {
    if (failed()) return Error{problem_};
    return std::move(items_);
  }

 private:
  template <typename Is>
  std::optional<std::size_t> indexWhere(Is is) const {
    const auto found = std::find_if(robot_.axes.begin(), robot_.axes.end(), is);
    if (found == robot_.axes.end()) return {};
    return static_cast<std::size_t>(found - robot_.axes.begin());
  }
  /// The sides of a gantry are homed together.
  void addSides(std::size_t axis, std::optional<int> order) {
    const config::CouplingConfig* const coupling = robot_.couplingOf(robot_.axes[axis].name);
    if (coupling == nullptr || !coupling->gantry) return add(axis, order, true);
    for (const std::string& side : coupling->axes) {
      const auto of = indexWhere([&](const drive::AxisConfig& any) { return any.name == side; });
      if (of) add(*of, order, true);
    }
  }
  void addGroup(const std::string& name, std::optional<int> order) {
    const auto group = std::find_if(robot_.groups.begin(), robot_.groups.end(),
                                    [&](const config::GroupConfig& of) { return of.name == name; });
    if (group == robot_.groups.end()) {
      problem_ = "there is no axis or group \"" + name + "\"";
      return;
    }
    bool any = false;
    for (const std::string& joint : group->joints) {
      for (std::size_t axis = 0; axis < robot_.axes.size(); ++axis) {
        if (!robot_.axes[axis].homing || !robot_.turns(robot_.axes[axis], joint)) continue;
        any = true;
        add(axis, order, false);
      }
    }
    if (!any) problem_ = "nothing to do: no axis of " + name + " has a `homing` section";
  }
  void add(std::size_t axis, std::optional<int> stated, bool named) {
    const int order = stated.value_or(robot_.axes[axis].homing->order);
    const auto known = std::find_if(items_.begin(), items_.end(),
                                    [&](const HomingItem& item) { return item.axis == axis; });
    if (known == items_.end()) return items_.push_back({axis, order, named});
    known->named = known->named || named;
    if (known->order == order) return;
    problem_ = drive::jointName(robot_.axes[axis]) + " is named twice, with the orders " +
               std::to_string(known->order) + " and " + std::to_string(order);
  }

  const config::RobotConfig& robot_;
  std::vector<HomingItem> items_;
  std::string problem_;
};

}  // namespace

Result<std::vector<HomingItem>> homingPlan(const config::RobotConfig& robot,
                                           const std::vector<std::string>& names,
                                           const std::vector<int>& order) {
  if (!order.empty() && order.size() != names.size()) {
    return Error{"`order` has " + std::to_string(order.size()) + " numbers for " +
                 std::to_string(names.size()) +
                 " names in `axes`; give one for each name, or none for the configured order"};
  }
  HomingPlan plan(robot);
  if (names.empty()) plan.addAll();
  for (std::size_t i = 0; i < names.size() && !plan.failed(); ++i) {
    plan.add(names[i], order.empty() ? std::nullopt : std::optional<int>(order[i]));
  }
  return plan.take();
}

void HomeCommand::begin(AxisCycle& cycle, const Reply<Answer>& reply, Time now) const {
  const std::string problem = cycle.enableProblem();
  if (!problem.empty()) return refuse(reply, "home is refused: " + problem);
  std::vector<ProcedureJob::Item> items;
  std::string left_out;
  for (const HomingItem& item : plan) {
    drive::Axis& axis = cycle.units()[item.axis].axis;
    if (!item.named && axis.device().excused()) {
      left_out += ProcedureJob::leftOut(axis);
    } else {
      items.push_back({&axis, item.order, item.axis});
    }
  }
  if (items.empty()) return refuse(reply, "nothing to do" + left_out);
  const std::string busy = ProcedureJob::homingRefusal(cycle.jobs(), items);
  if (!busy.empty()) return refuse(reply, busy);
  drive::ProcedureRequest request;
  request.kind = drive::ProcedureKind::home;
  ProcedureJob::Manner manner;
  manner.together = true;
  manner.id = id;
  manner.progress = progress;
  auto job = std::make_unique<ProcedureJob>(request, std::move(items), std::move(left_out),
                                            std::move(manner), reply);
  if (job->step(now)) return;
  if (begun) begun();
  cycle.jobs().add(std::move(job));
}

void CancelHomeCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time now) const {
  cycle.jobs().cancel(id, now);
  give(reply, answerOf(true, "home: cancelled"));
}

}  // namespace cia402::bus
