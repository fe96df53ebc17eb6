// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "cia402_driver/common/time.h"

namespace cia402::bus {

/// The time that trajectories run on: one period a cycle, however late the cycle is. When cycles
/// were missed the joints have come to rest, and the clock starts from standstill, too: its rate
/// rises to 1 as fast as the joints may accelerate.
class MotionClock {
 public:
  explicit MotionClock(Duration period) : period_(period) {}

  /// Nothing moves: the clock shows the time of the bus.
  void set(Time now) {
    time_ = cycled_ = now;
    rate_ = 1.0;
  }
  /// Nothing moves yet, or no more: goes with the time of the bus, but past `start` by one period
  /// at most. What was to start while no cycle ran starts from its beginning.
  void idle(Time now, Time start) {
    const Time time = time_ + (now - cycled_);
    time_ = start == kNever ? time : std::max(time_, std::min(time, start + period_));
    cycled_ = now;
    rate_ = 1.0;
  }
  /// A cycle at `now`. @param late some were missed before it: begins from standstill
  void cycle(Time now, bool late) {
    if (late) rate_ = 0.0;
    cycled_ = now;
  }
  /// The first cycle of a motion that begins between two cycles: by what has passed since, at most
  /// one period.
  void begin(Time now) {
    time_ += std::min(now - cycled_, period_);
    cycled_ = now;
  }
  /// Goes on by one period. @param rise 1/s, > 0, by which the rate may rise
  void advance(double rise) {
    rate_ = std::min(1.0, rate_ + rise * toSeconds(period_));
    time_ += rate_ == 1.0 ? period_ : fromSeconds(rate_ * toSeconds(period_));
  }
  Time time() const { return time_; }
  double rate() const { return rate_; }
  /// The clock's time at `then`, a time of the bus, as things are at `now`.
  Time at(Time then, Time now) const { return time_ + (then - now); }

 private:
  Duration period_;
  Time time_{}, cycled_{};
  double rate_ = 1.0;
};

}  // namespace cia402::bus
