// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "can/frame.h"
#include "canopen/config.h"

namespace cia402::bus {

/// Listens, before anything is sent, whether the bus has another master: two would command the same
/// drives. What only masters send tells: NMT, SYNC, a heartbeat with the master's own node-ID, node
/// guarding, SDO and LSS requests, RPDOs of the configured drives. Heartbeats, TPDOs, emergencies
/// and answers come from drives and mean nothing: a driver that was killed leaves drives behind
/// that send them.
class BusListener {
 public:
  /// @param duration the bus must be free of another master for so long; zero: nobody listens.
  /// SYNC means nothing with MasterConfig::external_sync.
  BusListener(const canopen::MasterConfig& master, Duration duration);

  /// Begins, or begins again.
  void start(Time now);
  bool listening() const { return end_ != kNever; }
  /// A frame came. @return true if it is one of another master and of a kind that is new.
  bool receive(const can::Frame& frame, Time now);
  /// When the bus will have been free for long enough; kNever: nobody listens.
  Time deadline() const { return end_; }
  void finish() { end_ = kNever; }

  /// Another master was heard since the start.
  bool heard() const { return !heard_.empty(); }
  /// What was heard and what that means, for people; empty if nothing was.
  std::string text() const;

 private:
  std::string kindOf(const can::Frame& frame) const;

  Duration duration_;
  canopen::NodeId node_;
  bool external_sync_;
  std::map<std::uint32_t, std::string> identifiers_;  ///< of configured drives, that masters send
  std::vector<std::string> heard_;
  Time end_ = kNever;
};

}  // namespace cia402::bus
