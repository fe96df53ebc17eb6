// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "drive/profile/profile.h"

namespace cia402::drive {

/// Bits of the statusword that tell the state (CiA 402-2, table "state coding").
inline constexpr std::uint16_t kStateBits = 0x006F;

/// The set bits by name: "voltage enabled, warning", or "no bit set".
/// @param mode names the bits that depend on the mode of operation; nullptr: it is not known.
/// @param words of the family, which count before those of the standard
std::string statusBitsText(std::uint16_t statusword, const ModeSpec* mode,
                           const StatusWords& words);

}  // namespace cia402::drive
