// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

namespace cia402::bus {

/// Bounded queue from any number of producer threads to one consumer thread, without a lock: no
/// producer ever waits for another one. Memory is taken at construction only.
template <typename T>
class MpscQueue {
 public:
  /// @param capacity largest number of waiting elements, at least 2.
  explicit MpscQueue(std::size_t capacity) : slots_(capacity) {
    for (std::size_t i = 0; i < capacity; ++i) slots_[i].turn.store(i, std::memory_order_relaxed);
  }

  /// Any thread. @return false if the queue is full; `value` is untouched then.
  [[nodiscard]] bool push(T&& value) {
    std::size_t ticket = tail_.load(std::memory_order_relaxed);
    for (;;) {
      Slot& slot = slots_[ticket % slots_.size()];
      const std::size_t turn = slot.turn.load(std::memory_order_acquire);
      if (turn < ticket) return false;  // holds what was pushed a round ago
      if (turn > ticket) {              // another producer was faster
        ticket = tail_.load(std::memory_order_relaxed);
      } else if (tail_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_relaxed)) {
        slot.value = std::move(value);
        slot.turn.store(ticket + 1, std::memory_order_release);
        return true;
      }
    }
  }
  /// Consumer. @return false if there is nothing, or its producer has not finished yet.
  [[nodiscard]] bool pop(T& value) {
    Slot& slot = slots_[head_ % slots_.size()];
    if (slot.turn.load(std::memory_order_acquire) != head_ + 1) return false;
    value = std::move(slot.value);
    slot.turn.store(head_ + slots_.size(), std::memory_order_release);
    ++head_;
    return true;
  }

 private:
  struct Slot {
    std::atomic<std::size_t> turn{0};  // the ticket it waits for; one more: it holds that value
    T value{};
  };

  std::vector<Slot> slots_;
  std::atomic<std::size_t> tail_{0};  // the next ticket
  std::size_t head_ = 0;
};

}  // namespace cia402::bus
