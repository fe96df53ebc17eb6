// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/reload_job.h"

#include <algorithm>
#include <utility>

#include "bus/network.h"
#include "common/text.h"
#include "fieldbus/abort_code.h"

namespace cia402::bus {
namespace {

using TransferFailure = fieldbus::Transfer::Failure;

/// The last write of an object is the one that counts.
const canopen::StartupWrite* lastWrite(const std::vector<canopen::StartupWrite>& writes,
                                       fieldbus::ObjectId object) {
  const auto found =
      std::find_if(writes.rbegin(), writes.rend(),
                   [&](const canopen::StartupWrite& write) { return write.object == object; });
  return found == writes.rend() ? nullptr : &*found;
}

Reload::Writes writesOf(const canopen::NodeConfig& now, const canopen::NodeConfig& next) {
  Reload::Writes writes;
  writes.node = next.node_id;
  writes.all = next.writes;
  for (const canopen::StartupWrite& write : next.writes) {
    if (&write != lastWrite(next.writes, write.object)) continue;
    const canopen::StartupWrite* const before = lastWrite(now.writes, write.object);
    if (before != nullptr && before->data == write.data) continue;
    writes.changed.push_back({write, {}});
    if (before != nullptr) writes.changed.back().former = before->data;
  }
  return writes;
}

/// Takes all over that needs no drive any more.
void apply(Network& network, Reload& reload, Time now) {
  AxisCycle& cycle = network.cycle();
  for (AxisUnit& unit : cycle.units()) unit.axis.adopt(reload.axes[unit.index], reload.at_rest);
  if (reload.at_rest) cycle.adoptLimits();
  for (std::size_t i = 0; i < reload.groups.size(); ++i) cycle.groups()[i].adopt(reload.groups[i]);
  for (Reload::Writes& writes : reload.nodes) {
    network.master().find(writes.node)->swapWrites(writes.all, now);
  }
}

/// Why the axis must keep its limits as yet; empty: it need not. Where its device is away nothing
/// is commanded before that was configured anew.
std::string refusal(drive::Axis& axis) {
  const drive::ProcedureStatus& procedure = axis.procedure();
  if (procedure.running) return std::string(toString(procedure.kind)) + " runs; wait for its end";
  const fieldbus::Health health = axis.device().health();
  if (health == fieldbus::Health::booting) {
    return "its drive is being configured; wait until that is ready";
  }
  return health == fieldbus::Health::ready ? axis.calibrationRefusal() : std::string();
}

/// Nobody asked for it by name, and the drive does not have it.
bool mayLack(const canopen::StartupWrite& write, const fieldbus::Transfer& answer) {
  return (write.optional || write.by_default) &&
         answer.failure() == TransferFailure::aborted_by_server &&
         fieldbus::abort_code::saysLacking(answer.abortCode());
}

/// Some drives send four bytes, whatever the type.
bool holdsSame(const fieldbus::Bytes& held, const fieldbus::Bytes& wanted) {
  const bool long_enough = held.size() >= wanted.size() && held.size() <= 8;
  return held == wanted ||
         (long_enough && fieldbus::toUnsigned(held) == fieldbus::toUnsigned(wanted));
}

}  // namespace

std::shared_ptr<Reload> makeReload(const ReloadSource& now, const ReloadSource& next,
                                   bool at_rest) {
  auto reload = std::make_shared<Reload>();
  reload->axes = next.robot.axes;
  reload->groups = next.robot.groups;
  reload->at_rest = at_rest;
  for (std::size_t i = 0; at_rest && i < next.master.nodes.size(); ++i) {
    reload->nodes.push_back(writesOf(now.master.nodes[i], next.master.nodes[i]));
  }
  return reload;
}

void ReloadCommand::begin(Network& network, const Reply<Answer>& reply, Time now) const {
  Answer answer;
  if (!reload->at_rest) {
    apply(network, *reload, now);
    answer.success = true;
    return give(reply, answer);
  }
  for (AxisUnit& unit : network.cycle().units()) {
    const std::string why_not = refusal(unit.axis);
    if (why_not.empty()) continue;
    answer.not_disabled = true;
    append(answer.message, drive::whoIs(unit.axis.config()) + ": " + why_not);
  }
  if (answer.not_disabled) return give(reply, answer);
  network.cycle().jobs().add(std::make_unique<ReloadJob>(network, *this, reply));
}

ReloadJob::ReloadJob(Network& network, const ReloadCommand& command, Reply<ReloadAnswer> reply)
    : Job(Turn::object, Ends::at_once),
      network_(network),
      reload_(command.reload),
      reply_(std::move(reply)) {
  for (AxisUnit& unit : network_.cycle().units()) unit.axis.beginCalibration("a new limit", false);
  for (Reload::Writes& writes : reload_->nodes) {
    canopen::Node* const node = network_.master().find(writes.node);
    for (Reload::Writes::Item& item : writes.changed) items_.push_back({node, &item});
  }
}

bool ReloadJob::step(Time now) {
  if (!ticket_) return next(now);
  if (!ticket_->done()) return false;
  switch (stage_) {
    case Stage::writing:
      return takeWritten(now);
    case Stage::comparing:
      return takeReadBack(now);
    case Stage::undoing:
      if (!ticket_->ok()) append(failure_, "not put back: " + ticket_->message() + "; recover it");
      return undo();
  }
  return false;
}

/// A node that is not ready gets all of it as it boots.
bool ReloadJob::next(Time now) {
  stage_ = Stage::writing;
  for (; at_ < items_.size(); ++at_) {
    if (!items_[at_].node->ready()) continue;
    const canopen::StartupWrite& write = items_[at_].item->write;
    ticket_ = items_[at_].node->objects().download(write.object, write.data, write.name);
    return false;
  }
  apply(network_, *reload_, now);
  ReloadAnswer answer;
  answer.success = true;
  answer.message = remarks_;
  finish(answer);
  return true;
}

std::string ReloadJob::textOf(const Item& item) const {
  const canopen::StartupWrite& write = item.item->write;
  return item.node->who() + ": " + fieldbus::toString(write.object) + " " + write.name + ": " +
         ticket_->reason();
}

bool ReloadJob::takeWritten(Time now) {
  const Item& item = items_[at_];
  const canopen::StartupWrite& write = item.item->write;
  const bool refused = ticket_->failure() == TransferFailure::aborted_by_server;
  if (!refused) taken_.push_back(item);  // or may have been
  const bool does_without = mayLack(write, *ticket_) || (write.optional && refused);
  if (!ticket_->ok() && !does_without && item.node->ready()) {
    return fail(textOf(item));
  }
  if (ticket_->ok()) {
    if (write.after_power) {
      append(remarks_, item.node->who() + ": " + write.name +
                           " counts once the drive was switched off and on");
    }
    if (item.node->config().reads_back) {
      stage_ = Stage::comparing;
      ticket_ = item.node->objects().upload(write.object, write.name);
      return false;
    }
  }
  ++at_;
  return next(now);
}

/// What cannot be read is believed.
bool ReloadJob::takeReadBack(Time now) {
  const Item& item = items_[at_];
  const canopen::StartupWrite& write = item.item->write;
  if (ticket_->ok() && !holdsSame(ticket_->data(), write.data)) {
    return fail(item.node->who() + ": the drive took " + write.name + " = " +
                std::to_string(fieldbus::toUnsigned(write.data)) + ", but holds " +
                std::to_string(fieldbus::toUnsigned(ticket_->data())) +
                "; look for a limit of its own");
  }
  ++at_;
  return next(now);
}

void ReloadJob::abandon(const std::string& why) {
  taken_.clear();
  (void)fail(why);
}

bool ReloadJob::fail(const std::string& why) {
  failure_ = why;
  return undo();
}

bool ReloadJob::undo() {
  stage_ = Stage::undoing;
  while (!taken_.empty()) {
    const Item item = taken_.back();
    taken_.pop_back();
    if (!item.item->former || !item.node->ready()) continue;
    const canopen::StartupWrite& write = item.item->write;
    ticket_ = item.node->objects().download(write.object, *item.item->former, write.name);
    return false;
  }
  ReloadAnswer answer;
  answer.message = failure_;
  finish(answer);
  return true;
}

void ReloadJob::finish(const ReloadAnswer& answer) {
  for (AxisUnit& unit : network_.cycle().units()) unit.axis.endCalibration();
  items_.clear();
  reload_.reset();  // the caller's alone from the reply on
  give(reply_, answer);
}

}  // namespace cia402::bus
