// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace cia402::canopen::sdo_block {

// What block upload and download have in common (CiA 301, 7.2.4.3.8 to 7.2.4.3.15).
constexpr unsigned kMostSegments = 127;   ///< of a sub-block
constexpr std::size_t kSegmentBytes = 7;  ///< of a segment but the last
constexpr std::uint8_t kCrcSupported = 0x04;
constexpr std::uint8_t kLastSegment = 0x80;
/// Sub-blocks in a row that bring nothing end the transfer.
constexpr unsigned kMostVain = 10;

}  // namespace cia402::canopen::sdo_block
