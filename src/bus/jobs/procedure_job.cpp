// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/procedure_job.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "bus/axis_cycle.h"
#include "bus/coupled_axes.h"
#include "common/text.h"
#include "motion/joint.h"

namespace cia402::bus {
namespace {

std::string motionOf(const drive::AxisState& state) {
  if (!state.feedback_valid) return "nothing tells whether it stands";
  if (std::isnan(state.velocity)) return "it moves";
  return "it moves (velocity " + motion::formatNumber(state.velocity) + ")";
}

/// Why what a procedure has achieved is not so any more; empty if it is.
/// @param replaced another one was called since
std::string lapse(const drive::ProcedureRequest& request, const drive::Axis& axis, bool replaced) {
  using drive::ProcedureKind;
  const drive::AxisState& state = axis.state();
  const std::string began =
      drive::jointName(axis.config()) + ": " + toString(request.kind) + " had succeeded, ";
  const std::string cause = replaced
                                ? began + "but " + toString(axis.procedure().kind) + " was called: "
                                : began + "but ";
  const bool enabled = state.state == drive::State::operation_enabled;
  const std::string now = std::string("it is ") + toString(state.state);
  switch (request.kind) {
    case ProcedureKind::recover:
      return axis.obstacle();
    case ProcedureKind::enable:
      return enabled ? std::string() : cause + now;
    case ProcedureKind::disable:
      if (!powerStageOff(state.state, state.statusword)) return cause + now;
      return axis.mayMove() ? cause + motionOf(state) : std::string();
    case ProcedureKind::clear_faults:
      return isFault(state.state) ? cause + now : std::string();
    case ProcedureKind::home:
    case ProcedureKind::set_position:
      return state.homed ? std::string() : cause + "it is not homed";
    case ProcedureKind::set_mode:
      if (axis.modeName() == drive::canonicalModeName(request.mode)) return {};
      return cause + "it is in mode " + axis.modeName();
    case ProcedureKind::halt:
    case ProcedureKind::quick_stop:
      if (replaced && enables(axis.procedure().kind)) return cause + now;
      return axis.mayMove() ? cause + motionOf(state) : std::string();
    default:
      return {};
  }
}

/// What is done to one side of a gantry is done to the other; parameters are the drive's own.
bool ofBothSides(drive::ProcedureKind kind) {
  return kind != drive::ProcedureKind::save_parameters &&
         kind != drive::ProcedureKind::restore_parameters;
}

int homingOrder(const drive::AxisConfig& axis) { return axis.homing ? axis.homing->order : 0; }

}  // namespace

bool ProcedureCommand::concerns(const AxisUnit& unit, const config::GroupConfig* of) const {
  const drive::AxisConfig& config = unit.axis.config();
  const CoupledAxes* coupling = unit.coupling;
  if (!axis.empty()) {
    const bool with_it = coupling != nullptr && coupling->asOne() && coupling->config().has(axis);
    return config.name == axis || (with_it && ofBothSides(request.kind));
  }
  if (request.kind == drive::ProcedureKind::home && !config.homing) return false;
  return of == nullptr ||
         std::any_of(of->joints.begin(), of->joints.end(), [&](const std::string& joint) {
           return coupling != nullptr ? coupling->config().moves(joint) : config.joint == joint;
         });
}

void ProcedureCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time now) const {
  const std::string problem = enables(request.kind) ? cycle.enableProblem() : std::string();
  if (!problem.empty()) {
    return refuse(reply, std::string(drive::toString(request.kind)) + " is refused: " + problem);
  }
  const auto of = std::find_if(cycle.groups().begin(), cycle.groups().end(),
                               [&](const Group& any) { return any.config().name == group; });
  const bool of_group = of != cycle.groups().end();
  if (!group.empty() && !of_group) return refuse(reply, "there is no group `" + group + "`");
  const bool homing = request.kind == drive::ProcedureKind::home;
  std::vector<AxisUnit*> units;
  std::vector<ProcedureJob::Item> items;
  std::string left_out;
  for (AxisUnit& unit : cycle.units()) {
    if (!concerns(unit, of_group ? &of->config() : nullptr)) continue;
    if (axis.empty() && unit.axis.device().excused()) {
      left_out += "; " + drive::jointName(unit.axis.config()) +
                  " is optional and not there, it was left out";
      continue;
    }
    units.push_back(&unit);
    items.push_back({&unit.axis, homing ? homingOrder(unit.axis.config()) : 0});
    if (stops(request.kind)) cycle.jobs().withdraw(unit.axis, request.kind);
  }
  if (items.empty()) {
    return refuse(reply, !axis.empty()      ? noSuchAxis(axis)
                         : left_out.empty() ? "nothing to do: no axis" +
                                                  (of_group ? " of " + group : std::string()) +
                                                  " has a `homing` section"
                                            : "nothing to do" + left_out);
  }
  // Until the devices can be reached again, where that takes more than their boot.
  const bool held = request.kind == drive::ProcedureKind::recover && cycle.prepareRecovery(units);
  ProcedureJob::Manner manner;
  manner.held = held;
  manner.together = of_group || (!axis.empty() && items.size() > 1);
  auto job =
      std::make_unique<ProcedureJob>(request, std::move(items), std::move(left_out), manner, reply);
  if (!job->step(now)) cycle.jobs().add(std::move(job));
}

ProcedureJob::ProcedureJob(drive::ProcedureRequest request, std::vector<Item> items,
                           std::string remark, Manner manner, Reply<> reply)
    : Job(Turn::procedure, Ends::at_once),
      request_(std::move(request)),
      reply_(std::move(reply)),
      remark_(std::move(remark)),
      manner_(manner) {
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.order < b.order; });
  for (const Item& item : items) {
    entries_.emplace_back();
    entries_.back().axis = item.axis;
    entries_.back().order = item.order;
  }
}

bool ProcedureJob::step(Time now) {
  watch();
  if (all(Stage::waiting) && !manner_.held && begunByAll()) refuseUnlessAll();
  const bool failed = std::any_of(entries_.begin(), entries_.end(),
                                  [](const Entry& e) { return e.stage == Stage::failed; });
  if (failed) {
    skipRest();
  } else if (!manner_.held) {
    startDue(now);
  }
  if (!ended() || awaitsNews(now)) return false;
  judge();
  if (!all(Stage::succeeded) && allOrNone()) undo(now);
  if (!ended()) return false;
  give(reply_, answer());
  return true;
}

bool ProcedureJob::all(Stage stage) const {
  return std::all_of(entries_.begin(), entries_.end(),
                     [stage](const Entry& entry) { return entry.stage == stage; });
}

bool ProcedureJob::ended() const {
  return std::all_of(entries_.begin(), entries_.end(),
                     [](const Entry& entry) { return entry.ended(); });
}

bool ProcedureJob::allOrNone() const {
  using drive::ProcedureKind;
  const bool undoable = request_.kind == ProcedureKind::set_mode ||
                        (manner_.together && request_.kind == ProcedureKind::enable);
  return undoable && entries_.size() > 1;
}

bool ProcedureJob::begunByAll() const {
  const bool homing = request_.kind == drive::ProcedureKind::home;
  return allOrNone() || (manner_.together && homing && entries_.size() > 1);
}

/// Nothing is begun where one axis cannot.
void ProcedureJob::refuseUnlessAll() {
  bool refused = false;
  for (Entry& entry : entries_) {
    std::string why = entry.axis->refusal(request_);
    if (why.empty()) continue;
    entry.fail(std::move(why));
    refused = true;
  }
  if (!refused) return;
  for (Entry& entry : entries_) {
    if (entry.stage == Stage::waiting) entry.refuse("another axis cannot");
  }
}

/// One axis has failed: the others go back to what they were.
void ProcedureJob::undo(Time now) {
  const bool switched_on = request_.kind == drive::ProcedureKind::enable;
  for (Entry& entry : entries_) switched_on ? switchOff(entry, now) : restoreMode(entry, now);
}

void ProcedureJob::switchOff(Entry& entry, Time now) const {
  if (entry.stage != Stage::succeeded) return;
  drive::Axis& axis = *entry.axis;
  const std::string name = drive::jointName(axis.config());
  if (entry.was_on) return entry.fail(name + ": it was enabled before, and stays so");
  if (axis.procedure().id != entry.id) {
    return entry.fail(name + ": " + toString(axis.procedure().kind) + " was called");
  }
  drive::ProcedureRequest off;
  off.kind = drive::ProcedureKind::disable;
  const Result<std::uint32_t> started = axis.start(off, now);
  if (!started) return entry.fail(name + ": it stays enabled: " + started.error().message);
  entry.fail(name + ": another axis failed");
  entry.stage = Stage::restoring;
  entry.id = *started;
}

void ProcedureJob::restoreMode(Entry& entry, Time now) const {
  drive::Axis& axis = *entry.axis;
  const bool succeeded = entry.stage == Stage::succeeded;
  if (succeeded) {
    entry.fail(drive::jointName(axis.config()) + ": it stays in mode " + axis.modeName());
  }
  if (entry.mode.empty() || axis.modeName() == entry.mode) return;
  if (axis.procedure().id != entry.id && stops(axis.procedure().kind)) {
    entry.message += ", as " + std::string(toString(axis.procedure().kind)) + " was called";
    return;  // who stopped it does not want it switched on again
  }
  drive::ProcedureRequest back = request_;
  back.mode = std::exchange(entry.mode, {});  // it is tried once
  if (succeeded) entry.message = drive::jointName(axis.config()) + ": another axis failed";
  const Result<std::uint32_t> started = axis.start(back, now);
  if (started) {
    entry.stage = Stage::restoring;
    entry.id = *started;
  } else {
    entry.message += "; it stays in mode " + axis.modeName() + ": " + started.error().message;
  }
}

/// What an axis answered may not be true any more when the last one has ended.
void ProcedureJob::judge() {
  if (entries_.size() == 1) return;
  for (Entry& entry : entries_) {
    const drive::Axis& axis = *entry.axis;
    std::string lapsed = lapse(request_, axis, axis.procedure().id != entry.id);
    if (entry.stage == Stage::succeeded && !lapsed.empty()) entry.fail(std::move(lapsed));
  }
}

/// What is told of several axes is told of all by news: one that has been silent of late shows soon
/// what became of it, or its feedback is stale.
bool ProcedureJob::awaitsNews(Time now) const {
  if (entries_.size() == 1 || !enables(request_.kind)) return false;
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    const drive::Axis& axis = *entry.axis;
    return entry.stage == Stage::succeeded && axis.state().feedback_valid && !axis.heardLately(now);
  });
}

void ProcedureJob::abandon(const std::string& why) {
  refuse(reply_, std::string(toString(request_.kind)) + ": " + why);
}

void ProcedureJob::startDue(Time now) {
  const auto open = std::find_if(entries_.begin(), entries_.end(),
                                 [](const Entry& e) { return e.stage != Stage::succeeded; });
  if (open == entries_.end()) return;
  const int order = open->order;
  for (Entry& entry : entries_) {
    if (entry.stage != Stage::waiting || entry.order != order) continue;
    const drive::AxisState& state = entry.axis->state();
    if (allOrNone()) entry.mode = entry.axis->modeName();
    entry.was_on = !drive::powerStageOff(state.state, state.statusword);
    const Result<std::uint32_t> started = entry.axis->start(request_, now);
    if (started) {
      entry.stage = Stage::running;
      entry.id = *started;
    } else {
      entry.fail(started.error().message);
    }
  }
  watch();  // what ends at once
}

void ProcedureJob::watch() {
  for (Entry& entry : entries_) {
    if (entry.stage == Stage::waiting) entry.watchWaiting();
    if (entry.stage == Stage::running || entry.stage == Stage::restoring) watchRunning(entry);
  }
}

std::string ProcedureJob::undone(const drive::Axis& axis, bool back) const {
  if (request_.kind == drive::ProcedureKind::enable) {
    return back ? "; it is disabled again" : "; it was not disabled again";
  }
  return (back ? "; it is back in mode " : "; it was not set back, it is in mode ") +
         axis.modeName();
}

void ProcedureJob::watchRunning(Entry& entry) const {
  const drive::Axis& axis = *entry.axis;
  const bool replaced = axis.procedure().id != entry.id;
  const drive::ProcedureStatus& status =
      replaced ? axis.previousProcedure() : axis.procedure();  // which may have ended well
  const bool its = status.id == entry.id;
  if (entry.stage == Stage::restoring) {
    if (its && status.running) return;
    const bool back = its && status.success;
    entry.stage = Stage::failed;
    entry.message += undone(axis, back);
    if (!back && its) entry.message += ": " + status.message;
  } else if (!its) {
    entry.fail(drive::jointName(axis.config()) + ": " + toString(request_.kind) +
               " was replaced by " + toString(axis.procedure().kind));
  } else if (!status.running) {
    entry.stage = status.success ? Stage::succeeded : Stage::failed;
    entry.message = status.message;
    entry.remark = status.remark;
  }
}

void ProcedureJob::Entry::fail(std::string why) {
  stage = Stage::failed;
  message = std::move(why);
}

void ProcedureJob::Entry::refuse(const std::string& why) {
  fail(drive::jointName(axis->config()) + ": not started, for " + why);
}

void ProcedureJob::withdraw(const drive::Axis& axis, drive::ProcedureKind by) {
  for (Entry& entry : entries_) {
    if (entry.stage != Stage::waiting || entry.axis != &axis) continue;
    entry.refuse(std::string(toString(by)) + " was called");
  }
}

void ProcedureJob::withdrawEnabling(const std::string& why) {
  if (!enables(request_.kind)) return;
  for (Entry& entry : entries_) {
    if (entry.stage == Stage::waiting) entry.refuse(why);
  }
}

/// Somebody who stops an axis does not want it moved by what was asked before.
void ProcedureJob::Entry::watchWaiting() {
  const drive::ProcedureStatus& status = axis->procedure();
  if (seen && status.id != id && stops(status.kind)) {
    refuse(std::string(toString(status.kind)) + " was called");
  }
  id = status.id;
  seen = true;
}

void ProcedureJob::skipRest() {
  for (Entry& entry : entries_) {
    if (entry.stage == Stage::waiting) entry.refuse("another axis failed");
  }
}

Answer ProcedureJob::answer() const {
  if (entries_.size() == 1) {
    const Entry& only = entries_.front();
    return answerOf(only.stage == Stage::succeeded, only.message + remark_);
  }
  const auto succeeded = std::count_if(entries_.begin(), entries_.end(),
                                       [](const Entry& e) { return e.stage == Stage::succeeded; });
  std::string text = std::string(toString(request_.kind)) + " done on " +
                     std::to_string(succeeded) + " of " + std::to_string(entries_.size()) + " axes";
  for (const Entry& entry : entries_) {
    const bool tells =
        entry.stage == Stage::failed || entry.remark || request_.kind == drive::ProcedureKind::home;
    if (!tells) continue;
    append(text, entry.message.empty() ? drive::jointName(entry.axis->config()) + ": done"
                                       : entry.message);
  }
  return answerOf(all(Stage::succeeded), text + remark_);
}

}  // namespace cia402::bus
