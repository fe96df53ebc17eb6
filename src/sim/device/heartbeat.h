// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/device/context.h"
#include "sim/device/emergency.h"

namespace cia402::sim {

/// Heartbeat producer (1017h) and consumers (1016h), CiA 301, 7.2.8.3.2.
class SlaveHeartbeat {
 public:
  SlaveHeartbeat(SlaveContext& context, SlaveEmergency& emergency)
      : context_(context), emergency_(emergency) {}

  /// Takes writes of its objects, where the dictionary has them.
  void serveObjects();
  /// Silent and watching nobody (power-on, reset).
  void reset();
  /// Sends the boot-up message, which counts as the first heartbeat, and begins to supervise.
  void start();
  /// A frame 0x700 + `node` was seen.
  void receive(canopen::NodeId node, const can::Frame& frame);
  void tick();
  Time deadline() const;

 private:
  struct Consumer {
    ObjectId id;
    canopen::NodeId node = 0;
    Duration time{};
    Time deadline = kNever;  // kNever until the first heartbeat, and once lost
    bool lost = false;
  };

  Duration period() const;
  void sendHeartbeat();
  std::uint32_t checkConsumer(const Entry& entry, std::uint64_t number) const;
  void configure(Consumer& consumer);
  void onLost(Consumer& consumer);
  bool anyLost() const;

  SlaveContext& context_;
  SlaveEmergency& emergency_;
  Time next_ = kNever;
  std::vector<Consumer> consumers_;
};

}  // namespace cia402::sim
