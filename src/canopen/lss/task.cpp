// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/lss/task.h"

#include <algorithm>
#include <utility>

namespace cia402::canopen {

LssTask::Status LssTask::advance(LssMaster& master, Time now) {
  return master.busy() ? Status::running : proceed(master, now);
}

LssTask::Status LssTask::ask(LssMaster& master, Time now, std::string step, LssRequest request) {
  step_ = std::move(step);
  master.begin(std::move(request), now);
  return Status::running;
}

LssTask::Status LssTask::done(std::string result) {
  step_ = "done";
  result_ = std::move(result);
  return Status::done;
}

LssTask::Status LssTask::fail(std::string error) {
  error_ = std::move(error);
  return Status::failed;
}

LssRequest lssWaitingRequest() {
  LssRequest request;
  request.confirmed = false;
  // Nobody confirms it, and a device that missed it would listen to what is meant for another.
  const can::Frame waiting = lss::switchGlobal(lss::State::waiting);
  request.frames = {waiting, waiting, waiting};
  return request;
}

LssRequest lssSelectRequest(const lss::Identity& identity) {
  LssRequest request;
  // A device that is in the configuration state already does not answer to its identity.
  request.frames = {lss::switchGlobal(lss::State::waiting)};
  for (const can::Frame& frame : lss::switchSelective(identity)) request.frames.push_back(frame);
  request.answer = lss::Command::switched;
  return request;
}

LssRequest lssInquireRequest(std::size_t part) {
  LssRequest request;
  request.frames = {lss::inquire(part)};
  request.answer = static_cast<lss::Command>(request.frames.front().data[0]);
  return request;
}

LssRequest lssInquireNodeIdRequest() {
  LssRequest request;
  request.frames = {lss::inquireNodeId()};
  request.answer = lss::Command::inquire_node_id;
  return request;
}

LssSelection::Status LssSelection::advance(LssMaster& master, Time now) {
  if (master.busy()) return Status::running;
  const Status status = check(master);
  if (status != Status::running) return status;
  switch (phase_) {
    case Phase::begin:
      phase_ = Phase::leaving;
      step_ = "switching all devices to the waiting state";
      master.begin(lssWaitingRequest(), now);
      break;
    case Phase::leaving: {
      phase_ = Phase::selecting;
      step_ = "selecting the device with " + lss::toString(identity_);
      LssRequest request = lssSelectRequest(identity_);
      request.attempts = attempts_;
      master.begin(std::move(request), now);
      break;
    }
    case Phase::selecting:
    case Phase::inquiring:
      phase_ = part_ < lss::kParts ? Phase::inquiring : Phase::node_id;
      if (phase_ == Phase::node_id) {
        step_ = "inquiring its node-ID";
        master.begin(lssInquireNodeIdRequest(), now);
      } else {
        step_ = std::string("inquiring its ") + lss::partName(part_);
        master.begin(lssInquireRequest(part_), now);
      }
      break;
    case Phase::node_id:
      return Status::done;
  }
  return Status::running;
}

/// Judges the answers to the request that has just ended.
LssSelection::Status LssSelection::check(LssMaster& master) {
  if (phase_ == Phase::begin || phase_ == Phase::leaving) return Status::running;
  if (!master.ok()) {
    error_ = "while " + step_ + ": " + master.problem();
    return phase_ == Phase::selecting && master.silent() ? Status::absent : Status::failed;
  }
  const can::Frame& answer = master.answers().front();
  if (phase_ == Phase::inquiring) {
    const std::uint32_t number = lss::numberOf(answer);
    if (number != identity_.part(part_)) {
      lss::Identity other;
      other.setPart(part_, number);
      error_ = "while " + step_ + ": a device answers with another one (" + lss::toString(other) +
               "): more than one is in the configuration state; nothing was configured, switch the "
               "others off and on";
      return Status::failed;
    }
    ++part_;
  } else if (phase_ == Phase::node_id) {
    node_id_ = lss::nodeIdOf(answer);
  }
  return Status::running;
}

LssTask::Status LssBitTimingTask::proceed(LssMaster& master, Time now) {
  switch (phase_) {
    case Phase::selecting: {
      const LssSelection::Status status = selection_.advance(master, now);
      show(selection_.step());
      if (status == LssSelection::Status::running) return Status::running;
      if (status != LssSelection::Status::done) {
        failure_ = selection_.error();
        return leave(master, now);
      }
      phase_ = Phase::configuring;
      LssRequest request;
      request.frames = {lss::configureBitTiming(*lss::bitTimingIndex(kbit_per_s_))};
      request.answer = lss::Command::configure_bit_timing;
      return ask(master, now, "setting the bit timing", std::move(request));
    }
    case Phase::configuring:
    case Phase::storing: {
      const auto refused = master.ok() ? lss::errorOf(master.answers().front()) : std::nullopt;
      if (!master.ok()) failure_ = "while " + step() + ": " + master.problem();
      if (refused) failure_ = "while " + step() + ": the device refused with " + *refused;
      if (!failure_.empty() || phase_ == Phase::storing || !store_) return leave(master, now);
      phase_ = Phase::storing;
      LssRequest request;
      request.frames = {lss::store()};
      request.answer = lss::Command::store;
      return ask(master, now, "storing the bit timing", std::move(request));
    }
    case Phase::leaving:
      break;
  }
  if (!failure_.empty()) return fail(failure_);
  return done(std::string(store_ ? "stored " : "set (not stored) ") + std::to_string(kbit_per_s_) +
              " kbit/s");
}

LssTask::Status LssBitTimingTask::leave(LssMaster& master, Time now) {
  phase_ = Phase::leaving;
  return ask(master, now, "leaving the configuration state", lssWaitingRequest());
}

LssTask::Status LssActivateTask::proceed(LssMaster& master, Time now) {
  LssRequest request;
  request.confirmed = false;
  switch (phase_++) {
    case 0: {
      const can::Frame all = lss::switchGlobal(lss::State::configuration);
      request.frames = {all, all, all};
      return ask(master, now, "switching all devices to the configuration state",
                 std::move(request));
    }
    case 1:
      request.frames = {lss::activateBitTiming(delay_ms_)};
      return ask(master, now, "activating the bit timing", std::move(request));
    default:
      return done("the devices were told to take the new bit timing");
  }
}

}  // namespace cia402::canopen
