// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "cia402_driver/common/time.h"

namespace cia402::can {

/// Maps the kernel's time stamps of received frames, which are on the wall clock, to the monotonic
/// clock. The offset is measured at every read. If the wall clock was stepped between stamp and
/// read, the result is impossible (later than now, or before the last time the socket was known to
/// be empty), and the time of the read is taken instead.
class WallClockMapping {
 public:
  /// One look at both clocks, in nanoseconds.
  struct Reading {
    std::int64_t monotonic = 0;
    std::int64_t wall = 0;
  };

  /// The socket was empty at this time.
  void setEmptyAt(Time monotonic) { empty_at_ = monotonic; }
  /// The clocks just after a read.
  void setReading(const Reading& reading) { reading_ = reading; }
  /// @param wall_stamp ns since 1970. @return the time on the monotonic clock.
  Time map(std::int64_t wall_stamp) const;
  /// The time of the read, for a frame without a stamp.
  Time timeOfReading() const { return Time(Duration(reading_.monotonic)); }

 private:
  Reading reading_;
  Time empty_at_ = Time::min();
};

/// CLOCK_MONOTONIC.
Time monotonicNow();

/// Both clocks as of the same moment, within a few microseconds.
WallClockMapping::Reading readClocks();

}  // namespace cia402::can
