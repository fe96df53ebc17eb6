// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "can/frame.h"

/// What libFuzzer calls, and test/fuzz for each file of the corpus.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace cia402::fuzz {

/// Ends the program if an invariant does not hold, which is a finding. Prints what was expected.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "invariant broken: %s\n", what);
  std::abort();
}

/// Takes numbers and frames from the bytes of an input; zeros after their end.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  bool empty() const { return left_ == 0; }
  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  std::uint32_t word() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 32; shift += 8) value |= std::uint32_t{byte()} << shift;
    return value;
  }
  /// At most `longest` bytes; the first byte says how many.
  std::vector<std::uint8_t> bytes(std::size_t longest) {
    std::vector<std::uint8_t> taken(byte() % (longest + 1));
    for (std::uint8_t& value : taken) value = byte();
    return taken;
  }
  /// A frame with 0 to 8 bytes, as any controller may deliver it.
  can::Frame frame(std::uint32_t id) {
    can::Frame frame;
    frame.id = id;
    const std::uint8_t shape = byte();
    frame.size = static_cast<std::uint8_t>(shape % 9);
    frame.remote = shape >= 0xF8;
    for (std::size_t i = 0; i < frame.size; ++i) frame.data[i] = byte();
    return frame;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

}  // namespace cia402::fuzz
