// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>

#include "can/frame.h"
#include "cia402_driver/common/time.h"

namespace cia402::benchmark {

/// A number that any difference in a run changes: FNV-1a, 64 bits, over words.
class Fingerprint {
 public:
  void add(std::uint64_t word) {
    for (int i = 0; i < 64; i += 8) value_ = (value_ ^ (word >> i & 0xFF)) * 0x100000001B3;
  }
  void add(double number) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    add(bits);
  }
  void add(const can::Frame& frame, Time time) {
    add(static_cast<std::uint64_t>(time.time_since_epoch().count()));
    add(std::uint64_t{frame.id} | std::uint64_t{frame.size} << 32 |
        std::uint64_t{frame.extended} << 40 | std::uint64_t{frame.remote} << 41 |
        std::uint64_t{frame.error} << 42);
    std::uint64_t data = 0;
    for (std::size_t i = 0; i < frame.size; ++i) data |= std::uint64_t{frame.data[i]} << 8 * i;
    add(data);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325;
};

}  // namespace cia402::benchmark
