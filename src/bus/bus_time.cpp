// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/bus_time.h"

#include <algorithm>

namespace cia402::bus {
namespace {

// What is due and was not done must not hold the time for ever.
constexpr Duration kLeast = std::chrono::microseconds(1);

}  // namespace

Time BusTime::advance(Time due) {
  const Time clock = clock_();
  if (kind_ == Kind::real) return clock;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (last_ == Time::min()) return last_ = clock;
  Time reached = std::max(clock - lostLocked(), last_);
  if (reached > last_ + kCatchUp) {
    losses_.push_back({last_, clock - last_});
    if (losses_.size() > kLosses) {
      forgotten_ = losses_.front().total;
      losses_.pop_front();
    }
    reached = last_;
  }
  return last_ = std::min(reached, std::max(due, last_ + kLeast));
}

Time BusTime::now() const {
  const Time clock = clock_();
  if (kind_ == Kind::real) return clock;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (last_ == Time::min()) return clock;
  return std::clamp(clock - lostLocked(), last_, last_ + kCatchUp);
}

Time BusTime::toClock(Time bus) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto next = std::lower_bound(losses_.begin(), losses_.end(), bus,
                                     [](const Loss& loss, Time time) { return loss.after < time; });
  return bus + (next == losses_.begin() ? forgotten_ : std::prev(next)->total);
}

Time BusTime::fromClock(Time clock) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto next =
      std::upper_bound(losses_.begin(), losses_.end(), clock,
                       [](Time time, const Loss& loss) { return time < loss.after + loss.total; });
  const Time went_on = clock - (next == losses_.begin() ? forgotten_ : std::prev(next)->total);
  return next == losses_.end() ? went_on : std::min(went_on, next->after);
}

Duration BusTime::lost() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return lostLocked();
}

Duration BusTime::lostLocked() const { return losses_.empty() ? forgotten_ : losses_.back().total; }

}  // namespace cia402::bus
