// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace cia402::can {

/// One classic CAN data or remote frame (ISO 11898-1), or an error frame reported by the
/// controller.
struct Frame {
  std::uint32_t id = 0;   ///< identifier, 11 or 29 bits; for an error frame the error class bits
  std::uint8_t size = 0;  ///< number of data bytes, 0..8
  bool extended = false;  ///< 29-bit identifier
  bool remote = false;    ///< remote transmission request: `size` is a length, there are no data
  bool error = false;     ///< error frame as in linux/can/error.h, never on the wire
  std::array<std::uint8_t, 8> data{};

  /// A data frame with identifier 0 and no bytes.
  Frame() = default;
  /// A data frame with an 11-bit identifier. Bytes beyond the eighth are ignored.
  Frame(std::uint32_t identifier, std::initializer_list<std::uint8_t> bytes) : id(identifier) {
    for (std::uint8_t byte : bytes) {
      if (size < data.size()) data[size++] = byte;
    }
  }
};

/// The same on the wire: bytes of `data` beyond `size`, and all of a remote frame, do not count.
inline bool operator==(const Frame& a, const Frame& b) {
  if (a.id != b.id || a.size != b.size || a.extended != b.extended || a.remote != b.remote ||
      a.error != b.error) {
    return false;
  }
  for (std::size_t i = 0; i < a.size && !a.remote; ++i) {
    if (a.data[i] != b.data[i]) return false;
  }
  return true;
}
inline bool operator!=(const Frame& a, const Frame& b) { return !(a == b); }

}  // namespace cia402::can
