// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "can/bus.h"
#include "canopen/nmt/nmt.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// Watches the heartbeat of one node (CiA 301, 7.2.8.3.2.2). Disarmed until arm() or the first
/// heard() after allow().
class HeartbeatConsumer {
 public:
  /// @param timeout without a heartbeat for this long the node is lost.
  explicit HeartbeatConsumer(Duration timeout) : timeout_(timeout) {}

  /// The next heartbeat starts the supervision.
  void allow() { allowed_ = true; }
  /// Starts the supervision at once: a node that never sends a heartbeat is lost, too.
  void arm(Time now);
  void disarm();
  /// A heartbeat came.
  void heard(Time now);

  bool armed() const { return deadline_ != kNever; }
  bool expired(Time now) const { return now >= deadline_; }
  Time deadline() const { return deadline_; }
  Duration timeout() const { return timeout_; }

 private:
  Duration timeout_;
  bool allowed_ = false;
  Time deadline_ = kNever;
};

/// Produces the heartbeat of the master (CiA 301, 7.2.8.3.2.2).
class HeartbeatProducer {
 public:
  /// @param period zero: none is produced.
  HeartbeatProducer(NodeId node, Duration period) : node_(node), period_(period) {}

  /// Sends the boot-up message, and the first heartbeat with it.
  void start(can::Sink& sink, Time now);
  /// Sends a heartbeat if one is due.
  void tick(can::Sink& sink, Time now);
  Time deadline() const { return deadline_; }

 private:
  void send(can::Sink& sink, NmtState state) const;

  NodeId node_;
  Duration period_;
  Time deadline_ = kNever;
};

}  // namespace cia402::canopen
