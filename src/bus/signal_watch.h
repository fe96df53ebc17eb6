// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "drive/axis/axis.h"

namespace cia402::bus {

/// The values of an axis that are only shown (`signals` of its profile), taken for those who look.
class SignalWatch {
 public:
  /// Somebody looks: what no TPDO brings is asked for, and taken for as long as an answer may take.
  void look(drive::Axis& axis, Time now) {
    axis.look();
    until_ = now + kWatch;
  }
  /// Once a cycle. Takes what has come, at most every kInterval; only that allocates.
  void watch(const drive::Axis& axis, Time now) {
    if (now < until_ && now >= next_) take(axis, now);
  }
  /// In the order of the profile; empty until somebody looked.
  const std::vector<drive::ShownSignal>& values() const { return values_; }
  /// Grows with each change of values().
  std::uint32_t version() const { return version_; }

 private:
  static constexpr Duration kWatch{std::chrono::seconds(3)};  ///< diagnostics look once a second
  static constexpr Duration kInterval{std::chrono::milliseconds(100)};
  [[gnu::cold]] void take(const drive::Axis& axis, Time now) {
    next_ = now + kInterval;
    if (axis.config().profile->signals.empty()) return;
    values_ = axis.signals(now);
    ++version_;
  }

  std::vector<drive::ShownSignal> values_;
  std::uint32_t version_ = 0;
  Time until_ = Time::min(), next_ = Time::min();
};

}  // namespace cia402::bus
