// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "cia402_driver/bus/jobs.h"
#include "cia402_driver/motion/joint.h"

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

}  // namespace

ProcedureJob::ProcedureJob(drive::ProcedureRequest request, std::vector<Item> items, Reply reply)
    : request_(std::move(request)), reply_(std::move(reply)) {
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.order < b.order; });
  for (const Item& item : items) {
    entries_.emplace_back();
    entries_.back().item = item;
  }
}

bool ProcedureJob::step(std::vector<drive::Axis>& axes, Time now) {
  watch(axes);
  const bool untouched = std::all_of(entries_.begin(), entries_.end(),
                                     [](const Entry& e) { return e.stage == Stage::waiting; });
  if (untouched && !held_ && allOrNone()) refuseUnlessAll(axes);
  const bool failed = std::any_of(entries_.begin(), entries_.end(),
                                  [](const Entry& e) { return e.stage == Stage::failed; });
  if (failed) {
    skipRest(axes);
  } else if (!held_) {
    startDue(axes, now);
  }
  if (!ended() || awaitsNews(axes, now)) return false;
  judge(axes);
  const bool all = std::all_of(entries_.begin(), entries_.end(),
                               [](const Entry& e) { return e.stage == Stage::succeeded; });
  if (!all && allOrNone()) restoreModes(axes, now);
  if (!ended()) return false;
  if (reply_) reply_(answer(axes));
  return true;
}

bool ProcedureJob::ended() const {
  return std::all_of(entries_.begin(), entries_.end(), [](const Entry& e) {
    return e.stage == Stage::succeeded || e.stage == Stage::failed;
  });
}

bool ProcedureJob::allOrNone() const {
  return request_.kind == drive::ProcedureKind::set_mode && entries_.size() > 1;
}

/// Nothing is begun where one axis cannot.
void ProcedureJob::refuseUnlessAll(const std::vector<drive::Axis>& axes) {
  bool refused = false;
  for (Entry& entry : entries_) {
    entry.message = axes[entry.item.axis].refusal(request_);
    if (entry.message.empty()) continue;
    entry.stage = Stage::failed;
    refused = true;
  }
  if (!refused) return;
  for (Entry& entry : entries_) {
    const drive::Axis& axis = axes[entry.item.axis];
    if (entry.stage == Stage::waiting) refuseToBegin(entry, axis, "another axis cannot");
  }
}

/// One axis has failed: the others go back to the mode that they had.
void ProcedureJob::restoreModes(std::vector<drive::Axis>& axes, Time now) {
  for (Entry& entry : entries_) {
    drive::Axis& axis = axes[entry.item.axis];
    const bool succeeded = entry.stage == Stage::succeeded;
    if (succeeded) {
      entry.stage = Stage::failed;
      entry.message = drive::jointName(axis.config()) + ": it stays in mode " + axis.modeName();
    }
    if (entry.mode.empty() || axis.modeName() == entry.mode) continue;
    if (axis.procedure().id != entry.id && stops(axis.procedure().kind)) {
      entry.message += ", as " + std::string(toString(axis.procedure().kind)) + " was called";
      continue;  // who stopped it does not want it switched on again
    }
    drive::ProcedureRequest back = request_;
    back.mode = entry.mode;
    if (succeeded) entry.message = drive::jointName(axis.config()) + ": another axis failed";
    const Result<std::uint32_t> started = axis.start(back, now);
    if (started) {
      entry.stage = Stage::restoring;
      entry.id = *started;
    } else {
      entry.message += "; it stays in mode " + axis.modeName() + ": " + started.error().message;
    }
    entry.mode.clear();  // it is tried once
  }
}

/// What an axis answered may not be true any more when the last one has ended.
void ProcedureJob::judge(const std::vector<drive::Axis>& axes) {
  if (entries_.size() == 1) return;
  for (Entry& entry : entries_) {
    const drive::Axis& axis = axes[entry.item.axis];
    const std::string lapsed = lapse(request_, axis, axis.procedure().id != entry.id);
    if (entry.stage != Stage::succeeded || lapsed.empty()) continue;
    entry.stage = Stage::failed;
    entry.message = lapsed;
  }
}

/// What is told of several axes is told of all by news: one that has been silent of late shows soon
/// what became of it, or its feedback is stale.
bool ProcedureJob::awaitsNews(const std::vector<drive::Axis>& axes, Time now) const {
  if (entries_.size() == 1 || !enables(request_.kind)) return false;
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    const drive::Axis& axis = axes[entry.item.axis];
    return entry.stage == Stage::succeeded && axis.state().feedback_valid && !axis.heardLately(now);
  });
}

void ProcedureJob::abandon(const std::string& why) {
  Answer answer;
  answer.message = std::string(toString(request_.kind)) + ": " + why;
  if (reply_) reply_(answer);
}

void ProcedureJob::startDue(std::vector<drive::Axis>& axes, Time now) {
  const auto open = std::find_if(entries_.begin(), entries_.end(),
                                 [](const Entry& e) { return e.stage != Stage::succeeded; });
  if (open == entries_.end()) return;
  const int order = open->item.order;
  for (Entry& entry : entries_) {
    if (entry.stage != Stage::waiting || entry.item.order != order) continue;
    if (allOrNone()) entry.mode = axes[entry.item.axis].modeName();
    const Result<std::uint32_t> started = axes[entry.item.axis].start(request_, now);
    entry.stage = started ? Stage::running : Stage::failed;
    if (started) {
      entry.id = *started;
    } else {
      entry.message = started.error().message;
    }
  }
  watch(axes);  // what ends at once
}

void ProcedureJob::watch(std::vector<drive::Axis>& axes) {
  for (Entry& entry : entries_) {
    const drive::Axis& axis = axes[entry.item.axis];
    if (entry.stage == Stage::waiting) watchWaiting(entry, axis);
    const bool restoring = entry.stage == Stage::restoring;
    if (entry.stage != Stage::running && !restoring) continue;
    const bool replaced = axis.procedure().id != entry.id;
    const drive::ProcedureStatus& status =
        replaced ? axis.previousProcedure() : axis.procedure();  // which may have ended well
    if (restoring && (status.id != entry.id || !status.running)) {
      const bool back = status.id == entry.id && status.success;
      entry.stage = Stage::failed;
      entry.message += (back ? "; it is back in mode " : "; it was not set back, it is in mode ") +
                       axis.modeName();
      if (!back && status.id == entry.id) entry.message += ": " + status.message;
    } else if (status.id != entry.id) {
      entry.stage = Stage::failed;
      entry.message = drive::jointName(axis.config()) + ": " + toString(request_.kind) +
                      " was replaced by " + toString(axis.procedure().kind);
    } else if (!status.running) {
      entry.stage = status.success ? Stage::succeeded : Stage::failed;
      entry.message = status.message;
      entry.remark = status.remark;
    }
  }
}

void ProcedureJob::refuseToBegin(Entry& entry, const drive::Axis& axis, const std::string& why) {
  entry.stage = Stage::failed;
  entry.message = drive::jointName(axis.config()) + ": not started, for " + why;
}

void ProcedureJob::withdraw(std::size_t axis, drive::ProcedureKind by,
                            const std::vector<drive::Axis>& axes) {
  for (Entry& entry : entries_) {
    if (entry.stage != Stage::waiting || entry.item.axis != axis) continue;
    refuseToBegin(entry, axes[axis], std::string(toString(by)) + " was called");
  }
}

void ProcedureJob::withdrawEnabling(const std::string& why, const std::vector<drive::Axis>& axes) {
  if (!enables(request_.kind)) return;
  for (Entry& entry : entries_) {
    if (entry.stage == Stage::waiting) refuseToBegin(entry, axes[entry.item.axis], why);
  }
}

/// Somebody who stops an axis does not want it moved by what was asked before.
void ProcedureJob::watchWaiting(Entry& entry, const drive::Axis& axis) {
  const drive::ProcedureStatus& status = axis.procedure();
  if (entry.seen && status.id != entry.id && stops(status.kind)) {
    refuseToBegin(entry, axis, std::string(toString(status.kind)) + " was called");
  }
  entry.id = status.id;
  entry.seen = true;
}

void ProcedureJob::skipRest(const std::vector<drive::Axis>& axes) {
  for (Entry& entry : entries_) {
    if (entry.stage != Stage::waiting) continue;
    refuseToBegin(entry, axes[entry.item.axis], "another axis failed");
  }
}

Answer ProcedureJob::answer(const std::vector<drive::Axis>& axes) const {
  Answer answer;
  if (entries_.size() == 1) {
    answer.success = entries_.front().stage == Stage::succeeded;
    answer.message = entries_.front().message + remark_;
    return answer;
  }
  const auto succeeded = std::count_if(entries_.begin(), entries_.end(),
                                       [](const Entry& e) { return e.stage == Stage::succeeded; });
  answer.success = static_cast<std::size_t>(succeeded) == entries_.size();
  answer.message = std::string(toString(request_.kind)) + " done on " + std::to_string(succeeded) +
                   " of " + std::to_string(entries_.size()) + " axes";
  for (const Entry& entry : entries_) {
    if (entry.stage == Stage::failed || entry.remark ||
        request_.kind == drive::ProcedureKind::home) {
      answer.message += "; " + (entry.message.empty()
                                    ? drive::jointName(axes[entry.item.axis].config()) + ": done"
                                    : entry.message);
    }
  }
  answer.message += remark_;
  return answer;
}

}  // namespace cia402::bus
