// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "can/bus.h"
#include "canopen/nmt/nmt.h"

namespace cia402::canopen {

/// Takes a node that works through NMT stop and start, with the configuration that it has: what
/// some drives want before they let a fault be reset. Both commands may be lost, so they are
/// repeated.
class NmtPause {
 public:
  static constexpr Duration kRepeat{std::chrono::milliseconds(20)};

  NmtPause(NodeId node, can::Sink& sink) : node_(node), sink_(sink) {}

  /// @param stopped how long it is to stay in that state. @param told whether its heartbeat, or its
  /// answer to guarding, tells its state; else it counts as started when it was told thrice.
  /// @param patience for it to tell that it has started
  void begin(Duration stopped, Duration patience, bool told, Time now);
  void end() { next_ = kNever; }
  bool active() const { return next_ != kNever; }
  /// It tells its state.
  void heard(NmtState state);
  /// @return false: it was told to start, and did not in time.
  bool tick(Time now);
  Time deadline() const { return next_; }

 private:
  NodeId node_;
  can::Sink& sink_;
  bool told_ = false, starting_ = false;
  unsigned starts_ = 0;
  Time start_at_{}, give_up_at_{}, next_ = kNever;
};

}  // namespace cia402::canopen
