// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cia402::sim {

/// Bits of a COB-ID entry (CiA 301, 7.5.2.5, 7.5.2.17, 7.5.2.35, 7.5.2.37).
inline constexpr std::uint32_t kCobIdInvalid = 0x80000000;
inline constexpr std::uint32_t kCobIdNoRtr = 0x40000000;
inline constexpr std::uint32_t kCobIdGenerateSync = 0x40000000;
inline constexpr std::uint32_t kCobIdMask = 0x7FF;

/// Whether the CAN-ID is one that no configurable object may use (CiA 301, table 42).
bool isRestrictedCanId(std::uint32_t id);

/// Checks a write to a COB-ID entry with a valid bit: bits 0..29 stay while the object exists,
/// only 11-bit identifiers, no restricted one. @return abort code or 0.
std::uint32_t checkCobId(std::uint32_t old, std::uint32_t next, bool disable_may_change_id);

}  // namespace cia402::sim
