// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/world/world.h"

namespace cia402 {

/// Another device on the bus, that sends what it is told to and hears nothing.
class Stranger final : public sim::Participant {
 public:
  explicit Stranger(sim::World& world) : port_(world.addParticipant("stranger", *this)) {}
  void receive(const can::Frame&, Time) override {}
  void tick(Time) override {}
  Time nextDeadline() const override { return kNever; }
  void send(const can::Frame& frame) { port_.send(frame); }

 private:
  sim::Port& port_;
};

}  // namespace cia402
