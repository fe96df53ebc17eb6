// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "can/bus.h"
#include "cia402_driver/common/time.h"

namespace cia402::can {

/// When to restart a controller that is bus-off: after a delay that grows with every attempt, for
/// a controller that falls off again at once has a disturbed bus, and each attempt disturbs the
/// others on it. Sans-IO: fed with time and state, it tells when an attempt is due.
class BusOffRecovery {
 public:
  /// How patient it is.
  struct Options {
    Duration first = std::chrono::milliseconds(100);  ///< before the first attempt
    Duration longest = std::chrono::seconds(5);       ///< the delay doubles up to this
    Duration calm = std::chrono::seconds(10);         ///< so long without bus-off: as at the start
  };

  BusOffRecovery() : BusOffRecovery(Options()) {}
  explicit BusOffRecovery(const Options& options) : options_(options), delay_(options.first) {}

  /// The controller's state at this time; to be called when it changes, and regularly.
  void update(BusState state, Time now) {
    const bool off = state == BusState::bus_off;
    if (off && !off_) {
      if (now >= well_since_ + options_.calm) delay_ = options_.first;
      due_ = now + delay_;
    } else if (!off && off_) {
      due_ = kNever;
      well_since_ = now;
    }
    off_ = off;
  }
  /// True once for each attempt that is due. The next one is due after twice the time.
  bool attempt(Time now) {
    if (now < due_) return false;
    ++attempts_;
    delay_ = std::min(2 * delay_, options_.longest);
    due_ = now + delay_;
    return true;
  }
  /// When attempt() is due; kNever if the controller is not bus-off.
  Time deadline() const { return due_; }
  /// Attempts since start.
  unsigned attempts() const { return attempts_; }

 private:
  Options options_;
  Duration delay_;
  bool off_ = false;
  Time due_ = kNever;
  Time well_since_ = Time(Duration::min() / 2);
  unsigned attempts_ = 0;
};

}  // namespace cia402::can
