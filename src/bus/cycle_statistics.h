// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "cia402_driver/common/time.h"

namespace cia402::bus {

/// How punctual the cycle is. SYNC lateness is the time from the absolute deadline to the moment
/// SYNC was handed to the interface.
class CycleStatistics {
 public:
  /// Upper ends of the bands that lateness is counted in, s; the last band has none.
  static constexpr std::array<double, 9> kBands{10e-6,  20e-6, 50e-6, 100e-6, 200e-6,
                                                500e-6, 1e-3,  2e-3,  5e-3};

  void syncSent(Duration lateness) {
    const double late = toSeconds(lateness);
    std::size_t band = 0;
    while (band < kBands.size() && late > kBands[band]) ++band;
    ++counts_[band];
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
  /// How many of them were no later than kBands[band], and later than the band before.
  std::uint64_t inBand(std::size_t band) const { return counts_[band]; }
  /// Cycles left out because the thread was late by more than a period.
  std::uint64_t overruns() const { return overruns_; }

 private:
  double last_ = 0.0, max_ = 0.0, sum_of_squares_ = 0.0;
  std::uint64_t count_ = 0, overruns_ = 0;
  std::array<std::uint64_t, kBands.size() + 1> counts_{};
};

}  // namespace cia402::bus
