// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "can/bus.h"
#include "can/bus_off_recovery.h"
#include "sim/bus/bus.h"

namespace cia402::sim {

/// A port of a simulated bus in the clothes of a CAN interface, for a master that runs in real time
/// with simulated drives in its own process. It drives the bus: maintain() and receive() advance
/// it.
class BusInterface final : public can::Interface, private Listener {
 public:
  /// What the controller and its driver in the kernel are like.
  struct Options {
    std::size_t receive_capacity = 1024;  ///< frames kept for receive(); more overflow, counted
    Duration restart_after{};  ///< recover from bus-off after this time; 0: never (`restart-ms`)
    /// Whether the driver may restart the controller itself where restart_after is 0, as with
    /// CAP_NET_ADMIN.
    bool may_restart = true;
    can::BusOffRecovery::Options recovery;
  };

  explicit BusInterface(Bus& bus, std::string name = "sim")
      : BusInterface(bus, std::move(name), {}) {}
  /// Attaches a port of that name to the bus, which must outlive it.
  BusInterface(Bus& bus, std::string name, const Options& options);
  BusInterface(const BusInterface&) = delete;
  BusInterface& operator=(const BusInterface&) = delete;

  /// What to call instead of Bus::advance(), e.g. a world that moves drives and bus together. It
  /// must bring the bus to the time it is given.
  void setAdvance(std::function<void(Time)> advance) { advance_ = std::move(advance); }

  /// As can::Interface says, on the simulated bus; time is that of the bus.
  bool send(const can::Frame& frame) override;
  std::optional<can::ReceivedFrame> receive(Time now) override;
  void maintain(Time now) override;
  int fd() const override { return -1; }
  can::BusState state() const override;
  const can::BusCounters& counters() const override { return counters_; }
  std::string describe() const override;
  std::string recovery() const override { return recovery_note_; }
  std::size_t pending() const override { return port_.pending(); }
  std::optional<ErrorCounters> errorCounters() const override;

  /// Frames that wait to be received.
  std::size_t waiting() const { return count_; }
  /// The port underneath, e.g. to pull its cable.
  Port& port() { return port_; }

 private:
  void onFrame(const can::Frame& frame, Time end_of_frame) override;
  void onSent(const can::Frame& frame, Time end_of_frame) override;
  void onStateChange(can::BusState state, Time now) override;
  void advance(Time now);
  void recover(Time now);
  void push(const can::Frame& frame, Time stamp);

  Bus& bus_;
  Options options_;
  Port& port_;
  std::function<void(Time)> advance_;
  std::vector<can::ReceivedFrame> ring_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  Time restart_at_ = kNever;
  can::BusOffRecovery recovery_;
  std::string recovery_note_;
  bool was_off_ = false;
  can::BusCounters counters_;
};

}  // namespace cia402::sim
