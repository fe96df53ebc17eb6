// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace cia402::canopen {

/// Goes on with the CRC of SDO block transfers (CiA 301, 7.2.4.3.16): polynomial
/// x^16 + x^12 + x^5 + 1, start value 0; of "123456789" it is 0x31C3.
std::uint16_t sdoCrc(std::uint16_t crc, const std::uint8_t* bytes, std::size_t size);

/// The CRC of a block transfer while its bytes come or go.
struct SdoChecksum {
  bool used = false;        ///< both sides compute it
  std::uint16_t value = 0;  ///< of the first `covered` bytes
  std::size_t covered = 0;

  /// Covers the bytes up to `until`; no effect where they are covered already. @param bytes all of
  /// the transfer, from its beginning
  void extend(const std::uint8_t* bytes, std::size_t until) {
    if (until <= covered) return;
    value = sdoCrc(value, bytes + covered, until - covered);
    covered = until;
  }
};

}  // namespace cia402::canopen
