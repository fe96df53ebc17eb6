// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "cia402_driver/common/time.h"

namespace cia402::bus {

/// How punctual the cycle is. SYNC lateness is the time from the absolute deadline to the moment
/// SYNC was handed to the interface.
class CycleStatistics {
 public:
  void syncSent(Duration lateness) {
    const double late = toSeconds(lateness);
    last_ = late;
    if (late > max_) max_ = late;
    sum_of_squares_ += late * late;
    ++count_;
  }
  void cyclesSkipped(std::uint64_t count) { overruns_ += count; }

  double lastLateness() const { return last_; }  ///< s
  double maxLateness() const { return max_; }    ///< s, since start
  /// Root of the mean square lateness in seconds since start; 0 before the first SYNC.
  double rmsLateness() const {
    return count_ == 0 ? 0.0 : std::sqrt(sum_of_squares_ / static_cast<double>(count_));
  }
  std::uint64_t cycles() const { return count_; }
  /// Cycles left out because the thread was late by more than a period.
  std::uint64_t overruns() const { return overruns_; }

 private:
  double last_ = 0.0, max_ = 0.0, sum_of_squares_ = 0.0;
  std::uint64_t count_ = 0, overruns_ = 0;
};

}  // namespace cia402::bus
