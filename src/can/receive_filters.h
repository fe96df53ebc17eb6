// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstdint>
#include <vector>

namespace cia402::can {

/// Frames to be received: those whose identifier equals `id` in the bits of `mask`.
struct ReceiveFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
  bool extended = false;  ///< 29-bit identifiers; false: 11-bit
};

/// Filters that pass the data and remote frames of these 11-bit identifiers, and no frame with 29
/// bits. The kernel compares a frame with each of them and takes 512 (CAN_RAW_FILTER_MAX), so they
/// are as few as blocks of identifiers allow; where 512 are not enough, neighbours pass, too.
/// Empty, which passes everything, if all identifiers are in the set.
std::vector<ReceiveFilter> receiveFilters(const std::bitset<2048>& identifiers);

}  // namespace cia402::can
