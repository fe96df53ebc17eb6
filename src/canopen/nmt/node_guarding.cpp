// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/nmt/node_guarding.h"

#include <algorithm>

#include "canopen/boot/text.h"
#include "common/text.h"

namespace cia402::canopen {
namespace {

constexpr std::uint8_t kToggleBit = 0x80;

}  // namespace

NodeGuard::NodeGuard(NodeId node, Duration guard_time, std::uint8_t life_time_factor)
    : node_(node), guard_time_(guard_time), factor_(life_time_factor) {}

void NodeGuard::start(bool after_reset, can::Sink& sink, Time now) {
  expected_ = after_reset ? std::optional<bool>(false) : std::nullopt;
  wrong_toggles_ = 0;
  answered_ = false;
  life_end_ = now + lifeTime();
  ask(sink, now);
}

void NodeGuard::stop() { next_ = life_end_ = kNever; }

can::Frame NodeGuard::request(NodeId node) {
  can::Frame frame;
  frame.id = 0x700U + node;
  frame.remote = true;
  frame.size = 1;  // the length of the answer
  return frame;
}

void NodeGuard::ask(can::Sink& sink, Time now) {
  sink.send(request(node_));
  next_ = now + guard_time_;
}

void NodeGuard::tick(can::Sink& sink, Time now) {
  if (now >= next_) ask(sink, now);
}

bool NodeGuard::receive(std::uint8_t answer, Time now) {
  if (!active()) return false;
  const bool toggle = (answer & kToggleBit) != 0;
  if (expected_ && *expected_ != toggle) {
    ++wrong_toggles_;
    return false;
  }
  expected_ = !toggle;
  answered_ = true;
  wrong_toggles_ = 0;
  life_end_ = now + lifeTime();
  return true;
}

Time NodeGuard::deadline() const { return std::min(next_, life_end_); }

std::string NodeGuard::loss() const {
  const std::string period =
      " for " + secondsText(lifeTime()) + " (asked every " + secondsText(guard_time_) + ")";
  if (wrong_toggles_ == 0) return "no answer to node guarding" + period;
  return "no valid answer to node guarding" + period + ": the toggle bit of " +
         std::to_string(wrong_toggles_) +
         " answers did not alternate; look for a second device with this node-ID";
}

}  // namespace cia402::canopen
