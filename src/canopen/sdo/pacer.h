// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// Shares the bus among the SDO requests of all nodes that boot at once. Each request gets a turn,
/// first come first served, and turns follow each other no faster than request and answer fit on
/// the wire. Without it the drives with low node-IDs would keep the others waiting until their
/// transfers time out, and heartbeats, whose identifiers are the least urgent of all, would starve.
class SdoPacer {
 public:
  /// @param bitrate bit/s; 0: every request may leave at once.
  explicit SdoPacer(double bitrate)
      : frame_(bitrate > 0.0 ? fromSeconds(kFrameBits / bitrate) : Duration::zero()) {}

  /// When the next request may leave, not before `now`; its turn is taken.
  Time turn(Time now) {
    const Time mine = std::max(next_, now);
    next_ = mine + 2 * frame_;  // the answer is as long
    return mine;
  }
  /// Other frames take their part of the bus; turns not yet given move back.
  void occupied(unsigned frames, Time now) {
    if (next_ > now) next_ += static_cast<std::int64_t>(frames) * frame_;
  }

 private:
  /// Of a data frame of eight bytes in the worst case of stuffing, the pause between frames
  /// included.
  static constexpr double kFrameBits = 135.0;

  Duration frame_;
  Time next_{};
};

}  // namespace cia402::canopen
