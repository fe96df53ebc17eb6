// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/cob_id.h"

#include "fieldbus/abort_code.h"

namespace cia402::sim {

namespace {

struct Range {
  std::uint32_t first, last;
};

constexpr Range kRestricted[] = {
    {0x000, 0x000},  // NMT
    {0x001, 0x07F},  // reserved
    {0x101, 0x180},  // reserved
    {0x581, 0x5FF},  // default SDO, server to client
    {0x601, 0x67F},  // default SDO, client to server
    {0x6E0, 0x6FF},  // reserved
    {0x701, 0x77F},  // NMT error control
    {0x780, 0x7FF},  // reserved
};

constexpr std::uint32_t kFixedWhileValid = 0x3FFFFFFF;
constexpr std::uint32_t kNotElevenBits = 0x3FFFF800;

}  // namespace

bool isRestrictedCanId(std::uint32_t id) {
  for (const Range& range : kRestricted) {
    if (id >= range.first && id <= range.last) return true;
  }
  return false;
}

std::uint32_t checkCobId(std::uint32_t old, std::uint32_t next, bool disable_may_change_id) {
  const bool was_valid = (old & kCobIdInvalid) == 0;
  const bool stays_valid = (next & kCobIdInvalid) == 0;
  const bool changes = ((old ^ next) & kFixedWhileValid) != 0;
  if ((next & kNotElevenBits) != 0) return fieldbus::abort_code::kInvalidValue;
  if (stays_valid && isRestrictedCanId(next & kCobIdMask)) {
    return fieldbus::abort_code::kInvalidValue;
  }
  if (was_valid && changes && (stays_valid || !disable_may_change_id)) {
    return fieldbus::abort_code::kInvalidValue;
  }
  return 0;
}

}  // namespace cia402::sim
