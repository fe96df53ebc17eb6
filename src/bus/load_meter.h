// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "can/bus.h"

namespace cia402::bus {

/// Stands between a network and its interface and measures how busy the bus is with what passes
/// here. Where the stuff bits are would have to be searched bit by bit; the true load lies between
/// the one without any and the one with as many as the frames could need.
class LoadMeter final : public can::Sink {
 public:
  /// @param sink where frames go; must outlive the meter. @param bitrate bit/s
  LoadMeter(can::Sink& sink, double bitrate) : sink_(sink), bitrate_(bitrate) {}

  /// Counts what the interface takes. Not inlined, as can::Pacer::send().
  [[gnu::noinline]] bool send(const can::Frame& frame) override {
    const bool taken = sink_.send(frame);
    if (taken) count(frame);
    return taken;
  }
  /// Counts a received frame.
  void count(const can::Frame& frame) {
    if (frame.error) return;
    const std::size_t bytes = frame.remote ? 0 : std::min<std::size_t>(frame.size, kMostBytes);
    ++counts_[frame.extended ? 1 : 0][bytes];
  }
  /// To be called now and then: begins a new second when one is over.
  void update(Time now) {
    const Duration elapsed = now - began_;
    if (elapsed < std::chrono::seconds(1)) return;
    measure(elapsed);
    began_ = now;
  }
  /// Share of the bit rate over the last full second, without stuff bits.
  double load() const { return load_; }
  /// The same with as many stuff bits as the frames could need.
  double mostLoad() const { return most_load_; }

 private:
  static constexpr std::size_t kMostBytes = 8;
  using Counts = std::array<std::uint64_t, kMostBytes + 1>;  ///< by the number of data bytes

  void measure(Duration elapsed);

  can::Sink& sink_;
  double bitrate_;
  std::array<Counts, 2> counts_{};  ///< of frames with a standard and with an extended identifier
  Time began_{};
  double load_ = 0.0, most_load_ = 0.0;
};

}  // namespace cia402::bus
