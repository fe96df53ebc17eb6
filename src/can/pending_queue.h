// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "can/frame.h"
#include "cia402_driver/common/time.h"

namespace cia402::can {

/// Frames that the kernel did not take yet, first in, first out, in a ring of fixed size: nothing
/// is allocated after construction. A frame that has waited too long is not sent any more: what it
/// says is no longer true.
class PendingQueue {
 public:
  /// How a frame may wait.
  struct Patience {
    Duration lifetime = Duration::max();  ///< thrown away if it is still here after this time
    bool newest_only = false;  ///< takes the place of a waiting frame of the same identifier
  };

  /// @param capacity at least 1.
  explicit PendingQueue(std::size_t capacity) : ring_(capacity > 0 ? capacity : 1) {}

  /// @return false if the queue is full; the frame is not taken then.
  bool push(const Frame& frame, Time now, const Patience& patience) {
    const Time expires = patience.lifetime >= kNever - now ? kNever : now + patience.lifetime;
    if (patience.newest_only) {
      for (std::size_t i = 0; i < count_; ++i) {
        Entry& entry = ring_[(first_ + i) % ring_.size()];
        if (entry.frame.id != frame.id || entry.frame.extended != frame.extended) continue;
        entry = {frame, expires};
        ++stale_;
        return true;
      }
    }
    if (count_ == ring_.size()) return false;
    ring_[(first_ + count_) % ring_.size()] = {frame, expires};
    ++count_;
    return true;
  }

  /// Gives the frames in order to `send` until that returns false; a frame it refused stays first.
  /// Frames whose time is over are left out. `send` may call discard().
  /// @return number of frames taken by `send`.
  template <typename Send>
  std::size_t flush(Time now, Send&& send) {
    std::size_t taken = 0;
    while (count_ > 0) {
      const Entry entry = ring_[first_];
      if (now >= entry.expires) {
        ++stale_;
        pop();
        continue;
      }
      if (!send(entry.frame) || count_ == 0) break;
      pop();
      ++taken;
    }
    return taken;
  }

  /// Throws everything away. @return how many frames that were.
  std::size_t discard() {
    const std::size_t discarded = count_;
    count_ = 0;
    return discarded;
  }

  std::size_t size() const { return count_; }
  std::size_t capacity() const { return ring_.size(); }
  bool empty() const { return count_ == 0; }
  /// Frames that were thrown away since construction because they were too old or a newer one of
  /// their identifier came.
  std::size_t stale() const { return stale_; }

 private:
  struct Entry {
    Frame frame;
    Time expires{};
  };

  void pop() {
    first_ = (first_ + 1) % ring_.size();
    --count_;
  }

  std::vector<Entry> ring_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::size_t stale_ = 0;
};

}  // namespace cia402::can
