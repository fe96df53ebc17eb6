// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "can/link_settings.h"

namespace cia402::can {

/// How busy a bus is, by what the kernel counts at its interface: all frames, whatever receive
/// filters let pass. The kernel counts frames and bytes of data, so each frame is taken for one
/// with an 11-bit identifier; one with 29 bits is 20 bits longer. Where the stuff bits are is not
/// known either: the true load lies between the one without any and the one with as many as there
/// can be.
class TrafficMeter {
 public:
  /// @param bitrate bit/s
  explicit TrafficMeter(double bitrate) : bitrate_(bitrate) {}

  /// To be called with what the kernel says now; a full second later there is a load.
  void update(const LinkSettings& link, Time now);
  /// Nothing is known of the interface at present.
  void reset() { *this = TrafficMeter(bitrate_); }

  /// How much of its time a bus is busy.
  struct Load {
    double nominal = 0.0, most = 0.0;  ///< shares of the bit rate: without stuff bits, with all
  };
  /// Over the last full second; nothing before there was one.
  const std::optional<Load>& load() const { return load_; }

 private:
  double bitrate_;
  std::optional<LinkSettings::Traffic> began_with_;
  Time began_{};
  std::optional<Load> load_;
};

}  // namespace cia402::can
