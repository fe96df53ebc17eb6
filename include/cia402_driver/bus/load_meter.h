// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cia402_driver/can/bus.h"
#include "cia402_driver/can/frame_bits.h"

namespace cia402::bus {

/// Stands between a robot and its interface and measures how busy the bus is with what passes here.
/// Where the stuff bits are would have to be searched bit by bit; the true load lies between the
/// one without any and the one with as many as the frames could need.
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
    if (frame.error) return;
    bits_ += (frame.extended ? 67u : 47u) + (frame.remote ? 0u : 8u * frame.size);
    most_bits_ += can::mostBits(frame);
  }
  /// To be called now and then: begins a new second when one is over.
  void update(Time now) {
    const Duration elapsed = now - began_;
    if (elapsed < std::chrono::seconds(1)) return;
    const double possible = bitrate_ * toSeconds(elapsed);
    load_ = static_cast<double>(bits_) / possible;
    most_load_ = static_cast<double>(most_bits_) / possible;
    bits_ = most_bits_ = 0;
    began_ = now;
  }
  /// Share of the bit rate over the last full second, without stuff bits.
  double load() const { return load_; }
  /// The same with as many stuff bits as the frames could need.
  double mostLoad() const { return most_load_; }

 private:
  can::Sink& sink_;
  double bitrate_;
  std::uint64_t bits_ = 0, most_bits_ = 0;
  Time began_{};
  double load_ = 0.0, most_load_ = 0.0;
};

}  // namespace cia402::bus
