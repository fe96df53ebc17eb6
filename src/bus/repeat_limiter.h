// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "cia402_driver/common/time.h"

namespace cia402::bus {

/// Lets the first few of equal news through and sums up the rest, so that a storm of them costs a
/// line every five seconds while every count stays exact: what take() let through and what the
/// summaries name add up to what came. Fixed memory; news of more kinds than it has room for are
/// summed up together.
class RepeatLimiter {
 public:
  static constexpr std::size_t kKinds = 16;  ///< kinds of news that are told apart
  static constexpr unsigned kAtOnce = 3;     ///< told at once within one interval
  static constexpr Duration kInterval = std::chrono::seconds(5);

  enum class Verdict : std::uint8_t {
    tell,       ///< tell it now
    tell_last,  ///< tell it now, and that further ones are summed up
    hold,       ///< it will be in a summary
  };
  /// News that were held back.
  struct Summary {
    std::uint32_t kind = 0;   ///< valid if not `others`
    bool others = false;      ///< of all kinds that there was no room for
    std::uint64_t count = 0;  ///< held back since the last summary of this kind
    Duration over{};          ///< the time since then
    std::uint64_t total = 0;  ///< since start, those told at once included
  };
  /// How often one kind of news came.
  struct Count {
    std::uint32_t kind = 0;
    std::uint64_t total = 0;  ///< since start
    Time last{};
  };

  /// News of a kind came.
  Verdict take(std::uint32_t kind, Time now);
  /// A summary that is due; to be called until there is none.
  std::optional<Summary> due(Time now) { return next(now, kInterval); }
  /// The same for whatever was held back, due or not: for the end of the program.
  std::optional<Summary> rest(Time now) { return next(now, Duration::zero()); }
  /// When due() has something at the earliest.
  Time deadline() const { return deadline_; }

  /// Kinds seen so far, in the order in which they came first.
  std::size_t kinds() const { return used_; }
  const Count& count(std::size_t i) const { return entries_[i].count; }
  /// News of kinds that there was no room for.
  std::uint64_t others() const { return entries_[kKinds].count.total; }

 private:
  struct Entry {
    Count count;
    Time began{};            // of the interval
    bool open = false;       // an interval runs
    unsigned told = 0;       // at once, since there was a quiet interval
    std::uint64_t held = 0;  // in this interval
  };

  Entry& find(std::uint32_t kind);
  std::optional<Summary> next(Time now, Duration interval);
  void updateDeadline();

  std::array<Entry, kKinds + 1> entries_{};  // the last one: all others
  std::size_t used_ = 0;
  Time deadline_ = kNever;
};

}  // namespace cia402::bus
