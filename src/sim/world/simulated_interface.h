// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "can/bus.h"
#include "sim/bus/interface.h"
#include "sim/world/robot_drives.h"
#include "sim/world/world.h"

namespace cia402::sim {

/// A CAN interface with simulated drives on it, all inside the process, in the time of whoever
/// calls receive(): for robots without hardware and without a CAN kernel.
class SimulatedInterface final : public can::Interface {
 public:
  /// Powers the drives on at `now`.
  SimulatedInterface(const std::vector<SimulatedDrive>& drives, double bitrate, Time now);

  bool send(const can::Frame& frame) override { return interface_.send(frame); }
  std::optional<can::ReceivedFrame> receive(Time now) override { return interface_.receive(now); }
  void maintain(Time now) override { interface_.maintain(now); }
  int fd() const override { return -1; }
  Time nextDeadline() const override { return world_.nextEvent(); }
  can::BusState state() const override { return interface_.state(); }
  const can::BusCounters& counters() const override { return interface_.counters(); }
  /// As can::Interface says, and how far the simulation is behind the clock.
  std::string describe() const override;
  std::string recovery() const override { return interface_.recovery(); }
  std::size_t pending() const override { return interface_.pending(); }
  std::optional<ErrorCounters> errorCounters() const override { return interface_.errorCounters(); }

  /// The drives, e.g. to inject faults; only from the thread that calls receive().
  World& world() { return world_; }
  /// The axis of that name in one of them; only from that thread, too.
  AxisOfDrive find(const std::string& axis);
  /// The driver's own controller, e.g. to send it to bus-off; only from that thread, too.
  Port& port() { return interface_.port(); }

 private:
  std::vector<SimulatedDrive> drives_;
  World world_;
  BusInterface interface_;
};

}  // namespace cia402::sim
