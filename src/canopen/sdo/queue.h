// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <string>

#include "canopen/sdo/transfer.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// The transfers of one SDO client in the order in which they are done: urgent ones before the
/// others, else first come first served. The front one is on the wire or next.
class SdoQueue {
 public:
  using Entry = std::shared_ptr<SdoTransfer>;

  /// Puts it behind those that go before it. Not nullptr.
  void add(Entry transfer);
  bool empty() const { return transfers_.empty(); }
  /// @pre not empty()
  SdoTransfer& front() { return *transfers_.front(); }
  const SdoTransfer& front() const { return *transfers_.front(); }
  /// @pre not empty()
  void pop() { transfers_.pop_front(); }
  /// Ends all of them as cancelled. @param reason the words behind "cancelled: "
  void cancelAll(NodeId node, const std::string& reason);

  /// No transfer starts before `when`, but for urgent ones.
  void holdUntil(Time when) { held_until_ = when; }
  /// When the front one may start: kNever if there is none, never before the beginning of time.
  Time nextStart() const;
  /// `*queued` becomes true with every transfer that is added; nullptr: nobody is told.
  void tellWhenQueued(bool* queued) { queued_ = queued; }

 private:
  std::deque<Entry> transfers_;
  Time held_until_{};
  bool* queued_ = nullptr;
};

}  // namespace cia402::canopen
