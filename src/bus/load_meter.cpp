// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/load_meter.h"

#include "can/frame_bits.h"

namespace cia402::bus {

void LoadMeter::measure(Duration elapsed) {
  std::uint64_t bits = 0, most_bits = 0;
  for (std::size_t bytes = 0; bytes <= kMostBytes; ++bytes) {
    can::Frame frame;
    frame.size = static_cast<std::uint8_t>(bytes);
    bits += counts_[0][bytes] * (47 + 8 * bytes) + counts_[1][bytes] * (67 + 8 * bytes);
    most_bits += counts_[0][bytes] * can::mostBits(frame);
    frame.extended = true;
    most_bits += counts_[1][bytes] * can::mostBits(frame);
  }
  const double possible = bitrate_ * toSeconds(elapsed);
  load_ = static_cast<double>(bits) / possible;
  most_load_ = static_cast<double>(most_bits) / possible;
  counts_ = {};
}

}  // namespace cia402::bus
