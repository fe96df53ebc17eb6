// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "can/frame.h"

namespace cia402::sim {

/// The value of `count` bytes from `offset` on, low byte first (CiA 301, 7.1.4).
inline std::uint64_t takeBytes(const can::Frame& frame, std::size_t offset, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = (value << 8U) | frame.data[offset + i];
  return value;
}

/// Puts `count` bytes of `value` at `offset`, low byte first.
inline void putBytes(can::Frame& frame, std::size_t offset, std::size_t count,
                     std::uint64_t value) {
  for (std::size_t i = 0; i < count; ++i) {
    frame.data[offset + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

/// A data frame of `size` zero bytes.
inline can::Frame emptyFrame(std::uint32_t id, std::uint8_t size) {
  can::Frame frame;
  frame.id = id;
  frame.size = size;
  return frame;
}

}  // namespace cia402::sim
