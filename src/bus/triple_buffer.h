// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace cia402::bus {

/// Hands the newest value from one writer thread to one reader thread without a lock: the writer
/// fills back() and publishes, the reader takes the newest published value. Neither ever waits.
template <typename T>
class TripleBuffer {
 public:
  /// @param initial what all three buffers hold at first; sizes its memory once.
  explicit TripleBuffer(const T& initial = T()) : buffers_{initial, initial, initial} {}

  /// Writer: the buffer to fill. It holds an older value, not the last published one.
  T& back() { return buffers_[back_]; }
  /// Writer: makes back() the newest value.
  void publish() {
    back_ =
        exchange_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) &
        kIndex;
  }
  /// Reader: true if a newer value than front() was published; front() is that value then.
  bool refresh() {
    if ((exchange_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = exchange_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }
  /// Reader: the newest value as of the last refresh().
  const T& front() const { return buffers_[front_]; }

 private:
  static constexpr std::uint8_t kIndex = 3, kFresh = 4;

  std::array<T, 3> buffers_;
  std::uint8_t back_ = 0;
  std::atomic<std::uint8_t> exchange_{1};
  std::uint8_t front_ = 2;
};

}  // namespace cia402::bus
