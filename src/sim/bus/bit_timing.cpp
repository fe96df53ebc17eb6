// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/bus/bit_timing.h"

#include <algorithm>
#include <array>

namespace cia402::sim {
namespace {

constexpr unsigned kCrcBits = 15;
constexpr unsigned kStandardHeaderBits = 19;  // SOF, 11 identifier, RTR, IDE, r0, 4 DLC
constexpr unsigned kExtendedHeaderBits = 39;  // SOF, 11, SRR, IDE, 18, RTR, r1, r0, 4 DLC

using CrcTable = std::array<std::uint16_t, 256>;

constexpr CrcTable makeCrcTable() {
  CrcTable table{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    unsigned crc = byte << 7;  // the byte at the top of a 15-bit register
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x4000U) != 0 ? (crc << 1) ^ 0x4599U : crc << 1;
    }
    table[byte] = static_cast<std::uint16_t>(crc & 0x7FFFU);
  }
  return table;
}

// The stuffing rule as an automaton that eats a byte at a time. A state is the level of the last
// bit on the wire (bit 2) and the number of equal bits up to it, less one (bits 1..0): 1 to 4, for
// after a fifth the stuff bit of the other level is the last one. An entry is next state | stuff
// bits << 3.
using StuffTable = std::array<std::array<std::uint8_t, 256>, 8>;

constexpr StuffTable makeStuffTable() {
  StuffTable table{};
  for (unsigned state = 0; state < 8; ++state) {
    for (unsigned byte = 0; byte < 256; ++byte) {
      unsigned level = state >> 2;
      unsigned run = (state & 3U) + 1;
      unsigned stuffed = 0;
      for (int i = 7; i >= 0; --i) {
        const unsigned bit = (byte >> i) & 1U;
        run = bit == level ? run + 1 : 1;
        level = bit;
        if (run == 5) {
          ++stuffed;
          level ^= 1U;
          run = 1;
        }
      }
      table[state][byte] = static_cast<std::uint8_t>(level << 2 | (run - 1) | stuffed << 3);
    }
  }
  return table;
}

constexpr CrcTable kCrcTable = makeCrcTable();
constexpr StuffTable kStuffTable = makeStuffTable();

inline unsigned crcStep(unsigned crc, unsigned byte) {
  return ((crc << 8) & 0x7FFFU) ^ kCrcTable[((crc >> 7) ^ byte) & 0xFFU];
}

inline unsigned dataBytes(const can::Frame& frame) {
  return frame.remote ? 0U : std::min<unsigned>(frame.size, 8U);
}

// Start of frame to data length code, as a number whose last bit is the last bit of the DLC.
std::uint64_t header(const can::Frame& frame) {
  const std::uint64_t remote = frame.remote ? 1 : 0;
  const std::uint64_t dlc = std::min<unsigned>(frame.size, 8U);
  if (!frame.extended) return (frame.id & 0x7FFULL) << 7 | remote << 6 | dlc;
  const std::uint64_t base = (frame.id >> 18) & 0x7FFULL;
  const std::uint64_t extension = frame.id & 0x3FFFFULL;
  return base << 27 | 3ULL << 25 | extension << 7 | remote << 6 | dlc;
}

unsigned headerBits(const can::Frame& frame) {
  return frame.extended ? kExtendedHeaderBits : kStandardHeaderBits;
}

unsigned stuffedRegionBits(const can::Frame& frame) {
  return headerBits(frame) + 8 * dataBytes(frame) + kCrcBits;
}

// Feeds the bits of the stuffed region to the automaton, collected to whole bytes.
class StuffCounter {
 public:
  // The region is 8n + 2 (standard) or 8n + 6 bits (extended) long. It is brought to whole bytes by
  // alternating bits in front that end with a recessive one: they need no stuffing and leave the
  // start of frame as the first of its run.
  explicit StuffCounter(bool extended) : bits_(extended ? 0x1U : 0x15U), count_(extended ? 2 : 6) {}

  void feed(std::uint64_t value, unsigned bits) {
    bits_ = bits_ << bits | value;
    count_ += bits;
    while (count_ >= 8) {
      count_ -= 8;
      const std::uint8_t entry = kStuffTable[state_][(bits_ >> count_) & 0xFFU];
      state_ = entry & 7U;
      stuffed_ += entry >> 3;
    }
  }
  unsigned stuffed() const { return stuffed_; }

 private:
  std::uint64_t bits_;
  unsigned count_;
  unsigned state_ = 4;  // a single recessive bit
  unsigned stuffed_ = 0;
};

}  // namespace

unsigned nominalBits(const can::Frame& frame) {
  if (frame.error) return 0;
  return stuffedRegionBits(frame) + kTrailerBits + kInterframeBits;
}

unsigned worstCaseBits(const can::Frame& frame) {
  if (frame.error) return 0;
  return nominalBits(frame) + (stuffedRegionBits(frame) - 1) / 4;
}

unsigned exactBits(const can::Frame& frame) {
  if (frame.error) return 0;
  const std::uint64_t head = header(frame);
  const unsigned data_bytes = dataBytes(frame);

  // Zeros in front of the message do not change a CRC that starts with 0: whole bytes from here on.
  unsigned crc = 0;
  for (int shift = frame.extended ? 32 : 16; shift >= 0; shift -= 8) {
    crc = crcStep(crc, static_cast<unsigned>(head >> shift) & 0xFFU);
  }
  StuffCounter stuff(frame.extended);
  stuff.feed(head, headerBits(frame));
  for (unsigned i = 0; i < data_bytes; ++i) {
    crc = crcStep(crc, frame.data[i]);
    stuff.feed(frame.data[i], 8);
  }
  stuff.feed(crc, kCrcBits);
  return nominalBits(frame) + stuff.stuffed();
}

std::uint16_t crc15(const std::uint8_t* bytes, std::size_t size) {
  unsigned crc = 0;
  for (std::size_t i = 0; i < size; ++i) crc = crcStep(crc, bytes[i]);
  return static_cast<std::uint16_t>(crc);
}

}  // namespace cia402::sim
