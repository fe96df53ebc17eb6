// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "canopen/lss/task.h"
#include "canopen/nmt/nmt.h"

namespace cia402::canopen {

LssTask::Status LssAssignTask::proceed(LssMaster& master, Time now) {
  switch (phase_) {
    case Phase::selecting:
      return select(master, now);
    case Phase::configuring:
    case Phase::storing:
      return configure(master, now);
    case Phase::leaving:
      break;
  }
  return finish();
}

LssTask::Status LssAssignTask::select(LssMaster& master, Time now) {
  const LssSelection::Status status = selection_.advance(master, now);
  show(selection_.step());
  if (status == LssSelection::Status::running) return Status::running;
  absent_ = status == LssSelection::Status::absent;
  if (status != LssSelection::Status::done) {
    failure_ = selection_.error();
    if (absent_) failure_ += "; check power, cable, bit rate and the four numbers";
    return leave(master, now);
  }
  const std::uint8_t present = selection_.nodeId();
  if (present == options_.node_id) return leave(master, now);
  const std::vector<NodeId> in_use = options_.in_use ? options_.in_use() : std::vector<NodeId>();
  const auto used = [&](std::uint8_t node) {
    return std::find(in_use.begin(), in_use.end(), node) != in_use.end();
  };
  if (used(present)) {
    failure_ = "the device has node-ID " + std::to_string(present) +
               ", which is that of a drive in operation: to give it up it would have to be reset, "
               "and the other with it; nothing was changed, power the device on alone";
  } else if (used(options_.node_id)) {
    failure_ = "node-ID " + std::to_string(options_.node_id) +
               " is that of a drive in operation by now; nothing was changed, choose another or "
               "take that drive off the bus";
  }
  if (!failure_.empty()) return leave(master, now);
  changed_ = true;
  phase_ = Phase::configuring;
  LssRequest request;
  request.frames = {lss::configureNodeId(options_.node_id)};
  request.answer = lss::Command::configure_node_id;
  return ask(master, now, "setting its node-ID to " + std::to_string(options_.node_id),
             std::move(request));
}

/// The answer to "configure node-ID" or "store configuration" is there.
LssTask::Status LssAssignTask::configure(LssMaster& master, Time now) {
  if (!master.ok()) {
    failure_ = "while " + step() + ": " + master.problem();
  } else if (const auto refused = lss::errorOf(master.answers().front())) {
    failure_ = "while " + step() + ": the device refused with " + *refused;
    if (phase_ == Phase::storing) failure_ += "; write `store: false`, or leave it out";
  }
  if (!failure_.empty() || phase_ == Phase::storing || !options_.store) return leave(master, now);
  phase_ = Phase::storing;
  LssRequest request;
  request.frames = {lss::store()};
  request.answer = lss::Command::store;
  return ask(master, now, "storing its node-ID", std::move(request));
}

LssTask::Status LssAssignTask::leave(LssMaster& master, Time now) {
  phase_ = Phase::leaving;
  return ask(master, now, "leaving the configuration state", lssWaitingRequest());
}

/// CiA 305: what had no node-ID boots by itself; anything else takes the new one with a reset. The
/// second is told to all that still go by 255: nobody who has a node-ID.
LssTask::Status LssAssignTask::finish() {
  if (!failure_.empty()) return fail(failure_);
  const std::string id = std::to_string(options_.node_id);
  const std::uint8_t before = selection_.nodeId();
  const bool had_one = lss::isNodeId(before);
  if (options_.reset) {
    sink_.send(nmtFrame(NmtCommand::reset_communication, lss::kUnconfigured));
    if (had_one && changed_) sink_.send(nmtFrame(NmtCommand::reset_communication, before));
  }
  if (!changed_) return done("the device has node-ID " + id + " already");
  return done("the device got node-ID " + id +
              (had_one ? " (it had " + std::to_string(before) + ")" : " (it had none)") +
              (options_.store ? " and stored it" : ", which it forgets without power"));
}

}  // namespace cia402::canopen
