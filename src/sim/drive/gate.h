// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "can/bus.h"

namespace cia402::sim {

/// Lets nothing out while the drive plays dead, or does not speak as the bus does.
class Gate : public can::Sink {
 public:
  explicit Gate(can::Sink& sink) : sink_(sink) {}
  bool send(const can::Frame& frame) override { return shut() || sink_.send(frame); }
  bool shut() const { return closed || foreign; }
  bool closed = false;
  bool foreign = false;

 private:
  can::Sink& sink_;
};

}  // namespace cia402::sim
