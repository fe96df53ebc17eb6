// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/sdo/block_crc.h"

namespace cia402::sim {
namespace {

// The division as the standard shows it: bit after bit, by x^16 + x^12 + x^5 + 1.
std::uint16_t remainderOf(const std::vector<std::uint8_t>& bytes) {
  unsigned remainder = 0;
  for (const std::uint8_t byte : bytes) {
    for (unsigned mask = 0x80; mask != 0; mask >>= 1U) {
      const bool feedback = ((remainder & 0x8000U) != 0) != ((byte & mask) != 0);
      remainder = (remainder << 1U) & 0xFFFFU;
      if (feedback) remainder ^= 0x1021U;
    }
  }
  return static_cast<std::uint16_t>(remainder);
}

}  // namespace

std::uint16_t sdoBlockCrc(const SdoChannel& channel) {
  const std::uint16_t crc = remainderOf(channel.data);
  const bool wrong = channel.context.behaviour.sdo_block_crc_error;
  return wrong ? static_cast<std::uint16_t>(crc ^ 0x5A5AU) : crc;
}

}  // namespace cia402::sim
