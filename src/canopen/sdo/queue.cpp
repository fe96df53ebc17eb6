// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/queue.h"

#include <algorithm>
#include <utility>

namespace cia402::canopen {
namespace {

constexpr Time kAtOnce{};  // the beginning of time, but no number that overflows in a subtraction

}  // namespace

void SdoQueue::add(Entry transfer) {
  const auto place = transfer->urgent()
                         ? std::find_if(transfers_.begin(), transfers_.end(),
                                        [](const Entry& queued) { return !queued->urgent(); })
                         : transfers_.end();
  transfers_.insert(place, std::move(transfer));
  if (queued_ != nullptr) *queued_ = true;
}

void SdoQueue::cancelAll(NodeId node, const std::string& reason) {
  for (const Entry& transfer : transfers_) {
    transfer->fail(node, SdoTransfer::Failure::cancelled, 0, "cancelled: " + reason);
  }
  transfers_.clear();
}

Time SdoQueue::nextStart() const {
  if (empty()) return kNever;
  return front().urgent() ? kAtOnce : std::max(kAtOnce, held_until_);
}

}  // namespace cia402::canopen
