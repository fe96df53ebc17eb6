// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "can/frame.h"

namespace cia402::can {

/// Bits that a frame can cost the bus at most: nominal length, as many stuff bits as any content
/// could need, and the three bits between frames (ISO 11898-1). A few instructions.
constexpr unsigned mostBits(const Frame& frame) {
  const unsigned data = frame.remote ? 0U : 8U * (frame.size < 8U ? frame.size : 8U);
  const unsigned stuffable = (frame.extended ? 54U : 34U) + data;
  return stuffable + 13U + (stuffable - 1U) / 4U;
}

/// Bits that this very frame costs the bus, its true stuff bits and the three bits between frames
/// included. Counts bit by bit: about a microsecond, not for every frame of the cycle.
unsigned wireBits(const Frame& frame);

}  // namespace cia402::can
