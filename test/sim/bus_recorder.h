// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/bus/bus.h"

namespace cia402::sim {

// Lengths counted by hand in bit_timing_test.cpp, the intermission of 3 bits included.
inline const can::Frame kSync(0x080, {});           ///< 51 bits
inline const can::Frame kHeartbeat(0x701, {0x05});  ///< 58 bits

/// A listener that keeps what it is told.
struct BusRecorder : Listener {
  struct Event {
    can::Frame frame;
    Time time;
  };
  std::vector<Event> frames;
  std::vector<Event> sent;
  std::vector<can::BusState> states;

  void onFrame(const can::Frame& frame, Time end_of_frame) override {
    frames.push_back({frame, end_of_frame});
  }
  void onSent(const can::Frame& frame, Time end_of_frame) override {
    sent.push_back({frame, end_of_frame});
  }
  void onStateChange(can::BusState state, Time) override { states.push_back(state); }

  std::vector<std::uint32_t> ids() const {
    std::vector<std::uint32_t> ids;
    for (const Event& event : frames) ids.push_back(event.frame.id);
    return ids;
  }
};

inline Time atNs(std::int64_t nanoseconds) { return Time(Duration(nanoseconds)); }
inline Time atUs(std::int64_t microseconds) { return atNs(microseconds * 1000); }

}  // namespace cia402::sim
