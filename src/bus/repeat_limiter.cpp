// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/repeat_limiter.h"

#include <algorithm>

namespace cia402::bus {

RepeatLimiter::Entry& RepeatLimiter::find(std::uint32_t kind) {
  for (std::size_t i = 0; i < used_; ++i) {
    if (entries_[i].count.kind == kind) return entries_[i];
  }
  if (used_ == kKinds) return entries_[kKinds];
  entries_[used_].count.kind = kind;
  return entries_[used_++];
}

RepeatLimiter::Verdict RepeatLimiter::take(std::uint32_t kind, Time now) {
  Entry& entry = find(kind);
  ++entry.count.total;
  entry.count.last = now;
  const bool over = entry.held == 0 && now >= entry.began + kInterval;
  if (!entry.open || over) {
    entry.open = true;
    entry.began = now;
    entry.told = 0;
    updateDeadline();
  }
  const bool room = entry.told < kAtOnce && &entry != &entries_[kKinds];
  if (!room) {
    ++entry.held;
    return Verdict::hold;
  }
  return ++entry.told == kAtOnce ? Verdict::tell_last : Verdict::tell;
}

std::optional<RepeatLimiter::Summary> RepeatLimiter::next(Time now, Duration interval) {
  if (interval > Duration::zero() && now < deadline_) return std::nullopt;
  for (std::size_t i = 0; i <= kKinds; ++i) {
    Entry& entry = entries_[i];
    if (!entry.open || now < entry.began + interval) continue;
    if (entry.held == 0) {
      entry.open = false;
      continue;
    }
    Summary summary;
    summary.kind = entry.count.kind;
    summary.others = i == kKinds;
    summary.count = entry.held;
    summary.over = now - entry.began;
    summary.total = entry.count.total;
    entry.held = 0;
    entry.began = now;
    return summary;
  }
  updateDeadline();
  return std::nullopt;
}

void RepeatLimiter::updateDeadline() {
  deadline_ = kNever;
  for (const Entry& entry : entries_) {
    if (entry.open) deadline_ = std::min(deadline_, entry.began + kInterval);
  }
}

}  // namespace cia402::bus
