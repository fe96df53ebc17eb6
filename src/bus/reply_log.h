// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "bus/command.h"
#include "bus/fixed_text.h"
#include "bus/mpsc_queue.h"
#include "bus/reply.h"
#include "cia402_driver/common/time.h"

namespace cia402::bus {

/// Permits something at most once in an interval. Any thread; never waits.
class Throttle {
 public:
  explicit Throttle(Duration interval) : interval_(interval.count()) {}
  bool permit(Time now) {
    const std::int64_t time = now.time_since_epoch().count();
    std::int64_t next = next_.load(std::memory_order_relaxed);
    return time >= next &&
           next_.compare_exchange_strong(next, time + interval_, std::memory_order_relaxed);
  }

 private:
  std::int64_t interval_;
  std::atomic<std::int64_t> next_{Time::min().time_since_epoch().count()};
};

/// Replies to commands that nobody waits for, on their way from the thread that gives them, mostly
/// that of the bus, to the one that logs them. Giving one never waits and takes no memory.
class ReplyLog {
 public:
  enum class Level : std::uint8_t { debug, warning, error };
  struct Entry {
    Level level = Level::debug;
    FixedText<512> text;
  };

  /// @param axes, groups how many there are.
  explicit ReplyLog(std::size_t axes, std::size_t groups = 0);

  /// For a set-point of an axis: refusals are warnings, at most one per second of each axis, so
  /// that a refused stream does not flood the log. The log must outlive the reply.
  Reply<> toSetpoint(std::size_t axis);
  /// The same for set-points of a group.
  Reply<> toGroupSetpoints(std::size_t group);
  /// For a trajectory: refusals are errors, points that had passed a warning. The log must outlive
  /// the reply.
  Reply<TrajectoryAnswer> toTrajectory();

  /// One thread: the next reply to log. @return false if there is none.
  bool next(Entry& entry) { return entries_.pop(entry); }
  /// Replies that found no room, since start.
  std::uint64_t lost() const { return lost_.load(); }

 private:
  static Reply<> toStream(ReplyLog& log, Throttle& refusals);
  void add(Level level, const std::string& text);

  MpscQueue<Entry> entries_;
  std::deque<Throttle> refusals_;        // of each axis
  std::deque<Throttle> group_refusals_;  // of each group
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace cia402::bus
