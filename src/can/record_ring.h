// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

namespace cia402::can {

/// The newest records in memory of a fixed size: the oldest is overwritten. One thread writes, and
/// never waits, allocates or copies more than the record; another may take a copy meanwhile, for
/// what is overwritten under its hands is noticed and left out (a sequence lock whose sequence is
/// the number of records).
template <typename T>
class RecordRing {
  static_assert(std::is_trivially_copyable<T>::value, "records are copied word by word");
  static_assert(sizeof(T) % sizeof(std::uint64_t) == 0, "records are whole words");

 public:
  /// Takes the memory. @param capacity records, at least 1.
  explicit RecordRing(std::size_t capacity)
      : capacity_(capacity > 0 ? capacity : 1), slots_(capacity_ + 1) {}

  /// Writer.
  void push(const T& record) {
    Slot words;
    std::memcpy(words.data(), &record, sizeof record);
    // A reader that sees any word of this record must see that the one before was counted.
    AtomicSlot& slot = slots_[next_];
    store(words, slot, std::make_index_sequence<kWords>());
    if (++next_ > capacity_) next_ = 0;
    written_.store(written_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Any thread: the records that are there, oldest first. Allocates.
  std::vector<T> copy() const {
    const std::uint64_t end = written_.load(std::memory_order_acquire);
    const std::uint64_t begin = end > capacity_ ? end - capacity_ : 0;
    std::vector<T> records(static_cast<std::size_t>(end - begin));
    Slot words;
    for (std::uint64_t i = begin; i < end; ++i) {
      const AtomicSlot& slot = slots_[static_cast<std::size_t>(i % slots_.size())];
      for (std::size_t k = 0; k < kWords; ++k) words[k] = slot[k].load(std::memory_order_acquire);
      void* const record = &records[static_cast<std::size_t>(i - begin)];
      std::memcpy(record, words.data(), sizeof(T));
    }
    dropOverwritten(records, begin);
    return records;
  }

  /// Records written since the start.
  std::uint64_t written() const { return written_.load(std::memory_order_acquire); }
  std::size_t capacity() const { return capacity_; }
  /// Bytes taken at construction.
  std::size_t memory() const { return slots_.size() * sizeof(T); }

 private:
  static constexpr std::size_t kWords = sizeof(T) / sizeof(std::uint64_t);
  using Slot = std::array<std::uint64_t, kWords>;
  using AtomicSlot = std::array<std::atomic<std::uint64_t>, kWords>;

  /// Word by word without a loop: compilers do not unroll one over atomics.
  template <std::size_t... I>
  static void store(const Slot& words, AtomicSlot& slot, std::index_sequence<I...> /*all*/) {
    (slot[I].store(words[I], std::memory_order_release), ...);
  }
  /// Removes what may have been overwritten while it was copied; a record may be in the making.
  void dropOverwritten(std::vector<T>& records, std::uint64_t begin) const {
    const std::uint64_t now = written_.load(std::memory_order_relaxed);
    const std::uint64_t valid = now >= slots_.size() ? now - slots_.size() + 1 : 0;
    const std::uint64_t lost = valid > begin ? valid - begin : 0;
    const auto count = static_cast<std::ptrdiff_t>(lost < records.size() ? lost : records.size());
    records.erase(records.begin(), records.begin() + count);
  }

  std::size_t capacity_;
  std::vector<AtomicSlot> slots_;  // one more than the capacity: the writer is in one
  std::size_t next_ = 0;           // the writer's
  std::atomic<std::uint64_t> written_{0};
};

}  // namespace cia402::can
