// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/procedure_job.h"

#include <algorithm>
#include <utility>

#include "bus/jobs/procedure_lapse.h"
#include "common/text.h"
#include "motion/joint.h"

namespace cia402::bus {
namespace {

/// So long an answer waits for a motor at the most: its load may drag it along for ever.
constexpr Duration kLongestStop{std::chrono::seconds(5)};

}  // namespace

ProcedureJob::ProcedureJob(drive::ProcedureRequest request, std::vector<Item> items,
                           std::string remark, Manner manner, Reply<ProcedureReport> reply)
    : Job(Turn::procedure, Ends::at_once),
      request_(std::move(request)),
      reply_(std::move(reply)),
      remark_(std::move(remark)),
      manner_(std::move(manner)) {
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.order < b.order; });
  for (const Item& item : items) {
    entries_.emplace_back();
    entries_.back().axis = item.axis;
    entries_.back().number = item.number;
    entries_.back().order = item.order;
    entries_.back().ready = item.axis->device().ready();
    entries_.back().boot_ups = item.axis->device().bootUps();
  }
}

std::string ProcedureJob::leftOut(const drive::Axis& axis) {
  return "; " + drive::jointName(axis.config()) + " is optional and not there, it was left out";
}

std::string ProcedureJob::homingRefusal(const JobList& jobs, const std::vector<Item>& items) {
  const auto busy = std::find_if(items.begin(), items.end(),
                                 [&](const Item& item) { return jobs.homes(*item.axis); });
  if (busy == items.end()) return {};
  return "home is refused: one that was called before has not ended, and " +
         drive::jointName(busy->axis->config()) +
         " is a part of it; wait for its end, or stop it by halt, quick_stop or disable";
}

bool ProcedureJob::step(Time now) {
  const bool done = advance(now);
  if (manner_.progress) {
    for (const Entry& entry : entries_) manner_.progress->set(entry.number, entry.stage);
  }
  if (done) give(reply_, answer());
  return done;
}

bool ProcedureJob::advance(Time now) {
  watch();
  if (all(Stage::waiting) && !manner_.held && begunByAll()) refuseUnlessAll();
  const bool failed = std::any_of(entries_.begin(), entries_.end(),
                                  [](const Entry& e) { return e.stage == Stage::failed; });
  if (failed) {
    skipRest();
  } else if (!manner_.held) {
    startDue(now);
  }
  if (!ended() || awaitsNews(now) || awaitsRest(now)) return false;
  judge();
  if (!all(Stage::succeeded) && allOrNone()) undo(now);
  return ended();
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
  if (entries_.size() == 1) return false;
  if (!enables(request_.kind) && !tellsWhatItIs(request_.kind)) return false;
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    const drive::Axis& axis = *entry.axis;
    return entry.stage == Stage::succeeded && axis.state().feedback_valid && !axis.heardLately(now);
  });
}

/// A search for home that somebody ended is answered once the motors stand, whatever stopped them.
bool ProcedureJob::awaitsRest(Time now) {
  if (request_.kind != drive::ProcedureKind::home) return false;
  if (!ended_) ended_ = now;
  const bool over = now >= *ended_ + kLongestStop;
  bool moves = false;
  for (Entry& entry : entries_) {
    if (entry.stage != Stage::failed || !entry.unwanted || !entry.may_move) continue;
    moves = true;
    if (!over) continue;
    entry.message += "; after " + motion::formatNumber(toSeconds(kLongestStop)) + " s " +
                     motionOf(entry.axis->state()) + ": see what drives it";
  }
  return moves && !over;
}

void ProcedureJob::Entry::watchFailed() {
  const drive::ProcedureStatus& last = axis->procedure();
  const bool led_on =
      last.id != id && enables(last.kind) && last.kind != drive::ProcedureKind::set_mode;
  may_move = may_move && !led_on && axis->state().feedback_valid && axis->mayMove();
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
      entry.may_move = true;
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
    if (entry.stage == Stage::failed) entry.watchFailed();
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
    if (replaced && stops(axis.procedure().kind)) entry.unwanted = true;
  }
}

void ProcedureJob::Entry::fail(std::string why) {
  stage = Stage::failed;
  message = std::move(why);
}

void ProcedureJob::Entry::refuse(const std::string& why) {
  fail(drive::jointName(axis->config()) + ": not started, for " + why);
}

void ProcedureJob::Entry::withdraw(const std::string& by) {
  refuse(by + " was called");
  unwanted = true;
}

void ProcedureJob::withdraw(const drive::Axis& axis, drive::ProcedureKind by) {
  for (Entry& entry : entries_) {
    if (entry.stage != Stage::waiting || entry.axis != &axis) continue;
    entry.withdraw(toString(by));
  }
}

void ProcedureJob::withdrawEnabling(const std::string& why) {
  if (!enables(request_.kind)) return;
  for (Entry& entry : entries_) {
    if (entry.stage == Stage::waiting) entry.refuse(why);
  }
}

/// Somebody who stops an axis does not want it moved by what was asked before; and a drive that was
/// lost, or has restarted, stays disabled until it is asked for anew.
void ProcedureJob::Entry::watchWaiting() {
  const fieldbus::Device& device = axis->device();
  if (ready && (!device.ready() || device.bootUps() != boot_ups)) {
    return refuse("its drive was lost, or has restarted, while it waited: call it again");
  }
  const drive::ProcedureStatus& status = axis->procedure();
  if (seen && status.id != id && stops(status.kind)) withdraw(toString(status.kind));
  id = status.id;
  seen = true;
}

void ProcedureJob::cancel(std::uint64_t id, Time now) {
  if (id == 0 || manner_.id != id) return;
  for (Entry& entry : entries_) {
    if (entry.ended()) continue;
    entry.unwanted = true;
    const bool runs = entry.stage == Stage::running && entry.axis->procedure().id == entry.id;
    if (entry.stage == Stage::waiting) entry.refuse("the goal was cancelled");
    if (runs) entry.axis->cancel("the client asked for it", now);
  }
}

bool ProcedureJob::homes(const drive::Axis& axis) const {
  return request_.kind == drive::ProcedureKind::home &&
         std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
           return entry.axis == &axis && entry.stage != Stage::failed;
         });
}

void ProcedureJob::skipRest() {
  const bool unwanted = std::none_of(entries_.begin(), entries_.end(), [](const Entry& entry) {
    return entry.stage == Stage::failed && !entry.unwanted;
  });
  for (Entry& entry : entries_) {
    if (entry.stage != Stage::waiting) continue;
    entry.refuse(unwanted ? "another axis was stopped" : "another axis failed");
    entry.unwanted = unwanted;
  }
}

ProcedureReport ProcedureJob::answer() const {
  ProcedureReport answer;
  answer.success = all(Stage::succeeded);
  answer.message = text() + remark_;
  answer.stopped = !answer.success;
  for (const Entry& entry : entries_) {
    if (entry.stage == Stage::failed && !entry.unwanted) answer.stopped = false;
    answer.axes.push_back({entry.number, entry.axis->state().homed, entry.message});
  }
  return answer;
}

std::string ProcedureJob::text() const {
  if (entries_.size() == 1) return entries_.front().message;
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
  return text;
}

}  // namespace cia402::bus
