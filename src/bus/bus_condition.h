// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "bus/condition.h"
#include "bus/link_findings.h"
#include "bus/snapshot.h"

namespace cia402::bus {

/// Cycles that were left out lately, so that a warning of them ends.
class SkippedCycles {
 public:
  static constexpr Duration kMemory{std::chrono::seconds(10)};

  /// @param overruns CycleStatistics::overruns(); call it at least once in kMemory
  void look(std::uint64_t overruns, Time now) {
    if (overruns != seen_) {
      lately_ += overruns - seen_;
      grown_ = now;
    } else if (now - grown_ >= kMemory) {
      lately_ = 0;
    }
    seen_ = overruns;
  }
  /// So many, with less than kMemory from each look that found some to the next one.
  std::uint64_t lately() const { return lately_; }

 private:
  std::uint64_t seen_ = 0, lately_ = 0;
  Time grown_{};
};

/// How well the bus is, but for what its interface is found to be set to.
/// @param load share of the bit rate
/// @param skipped SkippedCycles::lately()
Summary busSummaryOf(const NetworkSnapshot& snapshot, double load, std::uint64_t skipped);

/// What a finding counts as.
Condition conditionOf(const can::LinkFinding& finding);

}  // namespace cia402::bus
