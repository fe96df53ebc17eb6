// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "bus/flight_recorder.h"
#include "bus/load_meter.h"
#include "bus/network.h"
#include "bus/triple_buffer.h"
#include "robots.h"
#include "scripted_drives.h"

namespace cia402::benchmark {

/// A driver in virtual time whose drives have answered before the cycle begins, so that a cycle is
/// the driver's work alone: everything that BusRunner does in it but system calls.
class DrivenRobot final : private can::Sink, private bus::EventSink {
 public:
  /// Boots and enables all axes and begins a trajectory of `cycles` cycles; with 0 they hold.
  /// @throws std::runtime_error if that fails.
  DrivenRobot(int axes, double sync_period_s, int cycles);

  /// The drives' part: reads the last cycle's frames and lays out those of the next one.
  void prepare();
  /// The driver's part: SYNC leaves; the drives' frames come in, one at a time as they do on a bus;
  /// in the middle of the period motion is computed and the RPDOs leave.
  void cycle();

  /// The frames of one cycle, as prepare() and cycle() left them.
  const std::vector<can::Frame>& received() const { return incoming_; }
  const std::vector<can::Frame>& sent() const { return outgoing_; }
  /// @throws std::runtime_error unless all axes are where the trajectory wants them, or hold.
  void check() const;

 private:
  bool send(const can::Frame& frame) override;
  void onEvent(const bus::Event& event) override;
  void onEmergency(const bus::EmergencyEvent& event) override { recorder_.onEmergency(event); }

  template <typename Request>
  void runUntilAnswered(Request request);
  void step();
  void wake(Time now);
  void publish(Time now);
  void checkHeld() const;

  TestRobot config_;
  Duration period_;
  bool holds_;
  ScriptedDrives drives_;
  bus::LoadMeter meter_;
  bus::FlightRecorder recorder_;
  bus::Network network_;
  bus::TripleBuffer<bus::NetworkSnapshot> snapshots_;
  std::vector<can::Frame> incoming_, outgoing_;
  std::vector<bus::Event> events_;
  Time now_{}, sync_{}, began_{};
  std::uint64_t published_cycle_ = 0;
};

}  // namespace cia402::benchmark
