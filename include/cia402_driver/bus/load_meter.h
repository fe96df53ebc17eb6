// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cia402_driver/can/bus.h"

namespace cia402::bus {

/// Stands between a robot and its interface and measures how busy the bus is with what passes here.
/// Stuff bits are not known to software and not counted: the true load is up to a quarter higher.
class LoadMeter final : public can::Sink {
 public:
  LoadMeter(can::Sink& sink, double bitrate) : sink_(sink), bitrate_(bitrate) {}

  bool send(const can::Frame& frame) override {
    const bool taken = sink_.send(frame);
    if (taken) count(frame);
    return taken;
  }
  /// Counts a received frame.
  void count(const can::Frame& frame) {
    if (!frame.error) bits_ += (frame.extended ? 67u : 47u) + (frame.remote ? 0u : 8u * frame.size);
  }
  /// To be called now and then: begins a new second when one is over.
  void update(Time now) {
    const Duration elapsed = now - began_;
    if (elapsed < std::chrono::seconds(1)) return;
    load_ = static_cast<double>(bits_) / (bitrate_ * toSeconds(elapsed));
    bits_ = 0;
    began_ = now;
  }
  /// Share of the bit rate over the last full second.
  double load() const { return load_; }

 private:
  can::Sink& sink_;
  double bitrate_;
  std::uint64_t bits_ = 0;
  Time began_{};
  double load_ = 0.0;
};

}  // namespace cia402::bus
