// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "can/frame.h"
#include "cia402_driver/common/time.h"
#include "fieldbus/object.h"

namespace cia402::benchmark {

/// Drives that cost next to nothing: they answer as Layout::lean wants it, obey the controlword at
/// once, and stand at each SYNC where the last set-point wanted them. Nodes 1 to `count`; identity
/// and PDO parameters are what is written to them, any other object does not exist.
class ScriptedDrives {
 public:
  explicit ScriptedDrives(int count) : drives_(static_cast<std::size_t>(count) + 1) {}

  /// A frame of the master. What it leads to is appended to `out`.
  void receive(const can::Frame& frame, std::vector<can::Frame>& out);
  /// Heartbeats that are due.
  void tick(Time now, std::vector<can::Frame>& out);
  Time nextHeartbeat() const { return next_heartbeat_; }

 private:
  struct Drive {
    bool operational = false;
    std::uint16_t statusword = 0x0250;  // switch on disabled
    std::uint32_t position = 0;
    std::uint8_t mode = 0;
    Duration heartbeat{};
    Time next_heartbeat = kNever;
    std::map<fieldbus::ObjectId, std::uint32_t> objects;
  };

  void onNmt(const can::Frame& frame, std::vector<can::Frame>& out);
  void onSync(std::vector<can::Frame>& out);
  void onSdo(Drive& drive, const can::Frame& frame, std::vector<can::Frame>& out);
  static void onRpdo(Drive& drive, const can::Frame& frame);

  std::vector<Drive> drives_;  // by node-ID; 0 is nobody
  Time next_heartbeat_ = kNever;
};

}  // namespace cia402::benchmark
