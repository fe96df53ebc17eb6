// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "cia402_driver/common/time.h"

namespace cia402::sim {

/// When SYNC came last, and at what distance.
class SyncWatch {
 public:
  /// Without one for so long the drive does not count on SYNC.
  static constexpr Duration kSilence = std::chrono::milliseconds(100);

  /// None has come since power-on.
  void reset() { last_.reset(); }
  void onSync(Time now) {
    if (last_) interval_ = now - *last_;
    last_ = now;
  }
  /// Whether SYNC runs.
  bool runs(Time now) const { return last_ && now - *last_ < kSilence; }
  /// How long ago the last one came; an hour where none did.
  Duration since(Time now) const { return last_ ? now - *last_ : std::chrono::hours(1); }
  /// Whether one came in this moment.
  bool isNow(Time now) const { return last_ == now; }
  /// Between the last two; 0 before there were two.
  Duration interval() const { return interval_; }

 private:
  std::optional<Time> last_;
  Duration interval_{0};
};

}  // namespace cia402::sim
