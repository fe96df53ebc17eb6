// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sync/sync.h"

#include <algorithm>
#include <cmath>

namespace cia402::canopen {

can::Frame SyncProducer::next() {
  if (overflow_ == 0) return can::Frame(kSyncCobId, {});
  counter_ = counter_ >= overflow_ ? std::uint8_t{1} : static_cast<std::uint8_t>(counter_ + 1);
  return can::Frame(kSyncCobId, {counter_});
}

SyncConsumer::Observation SyncConsumer::receive(const can::Frame& frame, Time stamp) {
  Observation seen;
  ++received_;
  checkForm(frame);
  const Duration interval = stamp - last_;
  last_ = stamp;
  if (state_ != State::running) {
    state_ = State::running;
    seen.returned = true;
    restartMeasuring();
    return seen;
  }
  const double periods = toSeconds(interval) / toSeconds(period_);
  const bool lacks_sync = periods > kOneMissing;
  measure(interval, lacks_sync);
  if (lacks_sync) {
    seen.missed = static_cast<std::uint64_t>(std::lround(periods)) - 1;
    missed_ += seen.missed;
    return seen;
  }
  seen.regular = true;
  seen.deviation = interval - (measured_ > Duration::zero() ? measured_ : period_);
  return seen;
}

// Single long intervals lack a SYNC; where most are long, the period is another one.
void SyncConsumer::measure(Duration interval, bool lacks_sync) {
  sum_ += interval;
  if (!lacks_sync) {
    sum_of_short_ += interval;
    ++short_intervals_;
  }
  if (++intervals_ < kWindow) return;
  const bool mostly_short = 2 * short_intervals_ > kWindow;
  measured_ = mostly_short ? sum_of_short_ / short_intervals_ : sum_ / kWindow;
  restartMeasuring();
}

void SyncConsumer::restartMeasuring() {
  sum_ = sum_of_short_ = Duration::zero();
  intervals_ = short_intervals_ = 0;
}

void SyncConsumer::checkForm(const can::Frame& frame) {
  const bool odd = frame.size != (overflow_ == 0 ? 0 : 1);
  odd_forms_ = odd ? std::min(odd_forms_ + 1, kOddForms) : 0;
  if (odd || overflow_ == 0) {
    counter_ = 0;
    return;
  }
  const std::uint8_t expected =
      counter_ >= overflow_ ? std::uint8_t{1} : static_cast<std::uint8_t>(counter_ + 1);
  if (counter_ != 0 && frame.data[0] != expected) ++counter_errors_;
  counter_ = frame.data[0];
}

bool SyncConsumer::tick(Time now) {
  if (now < deadline()) return false;
  state_ = State::lost;
  return true;
}

bool SyncConsumer::periodWrong() const {
  if (measured_ == Duration::zero()) return false;
  return std::fabs(toSeconds(measured_ - period_)) > kTolerance * toSeconds(period_);
}

}  // namespace cia402::canopen
