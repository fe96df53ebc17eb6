// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cia402::drive {

/// Counts how often the number of a position has wrapped around, so that a joint that turns without
/// end shows no step there. Between two readings the shorter way is taken: a joint that turned by
/// more than half the range while nothing was heard of it reads whole ranges off.
class PositionUnwrap {
 public:
  PositionUnwrap() = default;  ///< counts nothing
  /// @param bits of the object, below 64
  PositionUnwrap(unsigned bits, bool is_signed)
      : shift_(64 - bits), counting_(bits < 64), signed_(is_signed) {}

  /// @return whether wraps() is another now
  bool update(std::uint64_t raw) {
    if (!counting_ || (known_ && raw == last_)) return false;
    const std::int64_t before = wraps_;
    if (known_ && !paused_) {
      const std::int64_t moved = extended(raw - last_, true);
      wraps_ += (number(last_) + moved - number(raw)) / (std::int64_t{1} << (64 - shift_));
    }
    last_ = raw;
    known_ = true;
    return wraps_ != before;
  }
  std::int64_t wraps() const { return wraps_; }
  bool counting() const { return counting_; }

  /// The drive gets another zero: what its number does until resume() is no motion.
  void restart(bool pause) {
    wraps_ = 0;
    known_ = false;
    paused_ = pause;
  }
  void resume() { paused_ = false; }

 private:
  std::int64_t extended(std::uint64_t raw, bool is_signed) const {
    const std::uint64_t top = raw << shift_;
    return is_signed ? static_cast<std::int64_t>(top) >> shift_
                     : static_cast<std::int64_t>(top >> shift_);
  }
  std::int64_t number(std::uint64_t raw) const { return extended(raw, signed_); }

  unsigned shift_ = 32;
  bool counting_ = false, signed_ = true, known_ = false, paused_ = false;
  std::uint64_t last_ = 0;
  std::int64_t wraps_ = 0;
};

}  // namespace cia402::drive
