// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/crc.h"

#include <array>

namespace cia402::canopen {
namespace {

constexpr std::array<std::uint16_t, 256> makeTable() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    unsigned crc = byte << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? crc << 1U ^ 0x1021U : crc << 1U;
    }
    table[byte] = static_cast<std::uint16_t>(crc & 0xFFFFU);
  }
  return table;
}
constexpr std::array<std::uint16_t, 256> kTable = makeTable();

}  // namespace

std::uint16_t sdoCrc(std::uint16_t crc, const std::uint8_t* bytes, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    const unsigned before = crc;
    const unsigned index = (before >> 8U ^ bytes[i]) & 0xFFU;
    crc = static_cast<std::uint16_t>(before << 8U ^ kTable[index]);
  }
  return crc;
}

}  // namespace cia402::canopen
