// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/device/context.h"
#include "sim/device/emergency.h"

namespace cia402::sim {

/// Node guarding and life guarding (CiA 301, 7.2.8.3.2.1; 100Ch, 100Dh). A device takes part that
/// has 100Ch or no 1017h; while 1017h is not 0 the heartbeat is used instead.
class SlaveGuarding {
 public:
  SlaveGuarding(SlaveContext& context, SlaveEmergency& emergency)
      : context_(context), emergency_(emergency) {}

  /// Takes writes of its objects, where the dictionary has them.
  void serveObjects();
  /// Watches nobody; the toggle bit begins at 0 again (power-on, reset).
  void reset();
  /// A frame with the CAN-ID 0x700 + node was seen: answers a remote request of any length code.
  void receive(const can::Frame& frame);
  void tick();
  Time deadline() const { return deadline_; }

 private:
  bool used() const;
  /// Guard time times life time factor; 0: not supervised.
  Duration lifeTime() const;
  void restart();

  SlaveContext& context_;
  SlaveEmergency& emergency_;
  bool exists_ = false;
  bool toggle_ = false;
  bool guarded_ = false;  // a request has come
  bool lost_ = false;
  Time deadline_ = kNever;
};

}  // namespace cia402::sim
