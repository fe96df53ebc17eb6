// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/definition/drive_definition.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// What an axis is doing that forbids some writes.
struct WriteSituation {
  std::int64_t mode = 0;  ///< in which it is
  bool enabled = false;   ///< operation enabled, quick stop active or fault reaction active
  bool powered = false;   ///< the power stage is on
};

/// SDO abort code against writing `number` into an object of the drive's own, 0 if allowed.
std::uint32_t refuseWrite(const DriveDefinition& definition, const DriveValues& values,
                          const WriteSituation& situation, const Entry& entry,
                          std::uint64_t number);

}  // namespace cia402::sim
