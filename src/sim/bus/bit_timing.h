// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "can/frame.h"

namespace cia402::sim {

/// Bits between two frames in which the bus stays recessive (ISO 11898-1 intermission). Every
/// length below includes them: back to back, a frame costs the bus exactly this many bits.
inline constexpr unsigned kInterframeBits = 3;

/// CRC delimiter, ACK slot, ACK delimiter and the seven bits of end of frame; never stuffed.
inline constexpr unsigned kTrailerBits = 10;

/// Length in bits from start of frame to the end of the intermission without any stuff bit.
unsigned nominalBits(const can::Frame& frame);

/// Length in bits with as many stuff bits as any content of this format and size could need: one
/// after the first five equal bits, then one after every four more (a stuff bit counts as the first
/// of the next five).
unsigned worstCaseBits(const can::Frame& frame);

/// Length in bits of this very frame: stuff bits counted from start of frame through the CRC
/// sequence, which is computed from the content. Error frames of the kernel have no length: 0.
unsigned exactBits(const can::Frame& frame);

/// The CRC sequence of ISO 11898-1, polynomial 0x4599, start value 0, of a string of whole bytes,
/// most significant bit first.
std::uint16_t crc15(const std::uint8_t* bytes, std::size_t size);

}  // namespace cia402::sim
