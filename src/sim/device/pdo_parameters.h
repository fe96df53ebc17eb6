// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/device/context.h"
#include "sim/device/mapping.h"

namespace cia402::sim {

/// The two records of a PDO: communication parameters 1400h/1800h + n, mapping 1600h/1A00h + n.
struct PdoRecords {
  PdoDirection direction;
  std::uint16_t communication;
  std::uint16_t mapping;
};

/// Sub-indices of a communication record (CiA 301, 7.5.2.35, 7.5.2.37).
namespace pdo_sub {
inline constexpr std::uint8_t kCobId = 1;
inline constexpr std::uint8_t kType = 2;
inline constexpr std::uint8_t kInhibitTime = 3;
inline constexpr std::uint8_t kEventTimer = 5;
inline constexpr std::uint8_t kSyncStart = 6;
}  // namespace pdo_sub

/// Whether bit 31 of the COB-ID is clear.
bool isValid(const SlaveContext& context, const PdoRecords& pdo);
/// Whether sub-index 0 of the mapping cannot be written and follows the entries instead.
bool countFollowsEntries(const SlaveContext& context, const PdoRecords& pdo);
/// Sets sub-index 0 of such a mapping to the number of entries before the first zero, or to the
/// number that it always has.
void countEntries(SlaveContext& context, const PdoRecords& pdo);

/// Sets bit 30 of the COB-ID of a TPDO, where the device insists on it.
void setRtrBit(SlaveContext& context, const PdoRecords& pdo);

/// Checks a write to a communication or mapping record. @return abort code or 0.
std::uint32_t checkCommunication(const SlaveContext& context, const PdoRecords& pdo,
                                 const Entry& entry, std::uint64_t number);
std::uint32_t checkMapping(const SlaveContext& context, const PdoRecords& pdo, const Entry& entry,
                           std::uint64_t number);

}  // namespace cia402::sim
