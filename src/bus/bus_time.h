// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>

#include "bus/real_clock.h"

namespace cia402::bus {

/// What time it is on a bus. A real bus goes on whatever this process does: its time is the
/// clock's. A bus inside this process stands still with it, so that no drive on it can miss a
/// driver that gets no processor. One thread advances the time, any may ask for it.
class BusTime {
 public:
  enum class Kind {
    real,  ///< the clock's
    /// Never passes an event that is due: what the thread is late for happens on time all the same,
    /// one event after another. Where it is late by more than kCatchUp, all of that is lost: the
    /// time goes on where it stood, and stays behind the clock for good.
    simulated,
  };
  /// More than the thread of the bus ever waits for by itself.
  static constexpr Duration kCatchUp = std::chrono::milliseconds(50);
  /// Losses that are remembered one by one.
  static constexpr std::size_t kLosses = 4096;

  /// @param clock a clock that never goes back, called by any thread.
  explicit BusTime(Kind kind = Kind::real, std::function<Time()> clock = realNow)
      : kind_(kind), clock_(std::move(clock)) {}

  /// The thread of the bus: what time it is now. @param due when something happens next.
  Time advance(Time due);
  /// Any thread: what time it is, as far as that thread has come.
  Time now() const;

  /// Any thread: when, by the clock, a moment on the bus was or will be if nothing more is lost.
  /// The same for one moment as often as it is asked, and in the same order as the moments.
  Time toClock(Time bus) const;
  /// Any thread: the moment on the bus at a time of the clock; while it stood, where it stood.
  Time fromClock(Time clock) const;
  /// Any thread: how far it is behind the clock.
  Duration lost() const;

 private:
  struct Loss {
    Time after;      ///< the moment on the bus at which it stood
    Duration total;  ///< lost since the start, this loss included
  };

  Duration lostLocked() const;

  const Kind kind_;
  const std::function<Time()> clock_;
  mutable std::mutex mutex_;
  Time last_ = Time::min();  // none yet
  std::deque<Loss> losses_;
  Duration forgotten_{};  // total of the losses that are no longer remembered
};

}  // namespace cia402::bus
