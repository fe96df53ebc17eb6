// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "cia402_driver/can/frame.h"

namespace cia402::can {

/// Frames that the kernel did not take yet, first in, first out, in a ring of fixed size: nothing
/// is allocated after construction.
class PendingQueue {
 public:
  /// @param capacity at least 1.
  explicit PendingQueue(std::size_t capacity) : ring_(capacity > 0 ? capacity : 1) {}

  /// @return false if the queue is full; the frame is not taken then.
  bool push(const Frame& frame) {
    if (count_ == ring_.size()) return false;
    ring_[(first_ + count_) % ring_.size()] = frame;
    ++count_;
    return true;
  }

  /// Gives the frames in order to `send` until that returns false; a frame it refused stays first.
  /// `send` may call discard().
  /// @return number of frames taken by `send`.
  template <typename Send>
  std::size_t flush(Send&& send) {
    std::size_t taken = 0;
    while (count_ > 0) {
      const Frame frame = ring_[first_];
      if (!send(frame) || count_ == 0) break;
      first_ = (first_ + 1) % ring_.size();
      --count_;
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

 private:
  std::vector<Frame> ring_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace cia402::can
