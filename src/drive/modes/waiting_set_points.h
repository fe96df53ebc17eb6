// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace cia402::drive {

/// Commands that wait to be handed to the drive one after the other; nothing allocates.
class WaitingSetPoints {
 public:
  static constexpr std::size_t kMost = 16;

  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == kMost; }
  double first() const { return values_[first_]; }  ///< @pre not empty
  /// @pre not full
  void add(double value) { values_[(first_ + count_++) % kMost] = value; }
  /// @pre not empty
  void removeFirst() {
    first_ = (first_ + 1) % kMost;
    --count_;
  }
  void clear() { first_ = count_ = 0; }

 private:
  std::array<double, kMost> values_{};
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace cia402::drive
