// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/frame_bits.h"

#include <algorithm>

namespace cia402::can {
namespace {

constexpr unsigned kCrcPolynomial = 0x4599;  // ISO 11898-1, without x^15
constexpr unsigned kCrcBits = 15;
constexpr unsigned kUnstuffedBits = 13;  // CRC delimiter, ACK 2, end of frame 7, pause 3

/// Counts the bits of the stuffed part of a frame as they go over the wire.
class BitStream {
 public:
  void put(unsigned value, unsigned count) {
    for (unsigned i = count; i-- > 0;) put((value >> i & 1U) != 0);
  }
  void putCrc() {
    const unsigned crc = crc_;
    put(crc, kCrcBits);
  }
  unsigned count() const { return count_; }

 private:
  void put(bool bit) {
    const bool carry = ((crc_ >> (kCrcBits - 1U) & 1U) != 0) != bit;
    crc_ = (crc_ << 1U & 0x7FFFU) ^ (carry ? kCrcPolynomial : 0U);
    run_ = bit == level_ ? run_ + 1 : 1;
    level_ = bit;
    ++count_;
    if (run_ < 5) return;
    ++count_;  // the stuff bit has the other level and begins a run of its own
    level_ = !level_;
    run_ = 1;
  }

  unsigned crc_ = 0, count_ = 0, run_ = 0;
  bool level_ = true;  // recessive before the start of frame
};

}  // namespace

unsigned wireBits(const Frame& frame) {
  if (frame.error) return 0;
  const unsigned size = std::min<unsigned>(frame.size, 8U);
  const unsigned remote = frame.remote ? 1U : 0U;
  BitStream bits;
  bits.put(0, 1);  // start of frame
  if (frame.extended) {
    bits.put(frame.id >> 18U & 0x7FFU, 11);
    bits.put(3, 2);  // SRR, IDE
    bits.put(frame.id & 0x3FFFFU, 18);
    bits.put(remote, 1);
    bits.put(0, 2);  // r1, r0
  } else {
    bits.put(frame.id & 0x7FFU, 11);
    bits.put(remote, 1);
    bits.put(0, 2);  // IDE, r0
  }
  bits.put(size, 4);
  for (unsigned i = 0; i < size && !frame.remote; ++i) bits.put(frame.data[i], 8);
  bits.putCrc();
  return bits.count() + kUnstuffedBits;
}

}  // namespace cia402::can
