// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

namespace cia402::bus {

/// Bounded queue from one producer thread to one consumer thread, without a lock. Memory is taken
/// at construction only.
template <typename T>
class SpscQueue {
 public:
  /// @param capacity largest number of waiting elements, at least 1.
  explicit SpscQueue(std::size_t capacity) : slots_(capacity + 1) {}

  /// Producer. @return false if the queue is full; `value` is untouched then.
  [[nodiscard]] bool push(T&& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = after(tail);
    if (next == head_.load(std::memory_order_acquire)) return false;
    slots_[tail] = std::move(value);
    tail_.store(next, std::memory_order_release);
    return true;
  }
  /// Consumer. @return false if there is nothing.
  [[nodiscard]] bool pop(T& value) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return false;
    value = std::move(slots_[head]);
    head_.store(after(head), std::memory_order_release);
    return true;
  }
  bool empty() const {
    return head_.load(std::memory_order_acquire) == tail_.load(std::memory_order_acquire);
  }

 private:
  std::size_t after(std::size_t index) const { return index + 1 == slots_.size() ? 0 : index + 1; }

  std::vector<T> slots_;
  std::atomic<std::size_t> head_{0}, tail_{0};
};

}  // namespace cia402::bus
