// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "cia402_driver/canopen/config.h"

namespace cia402::canopen {

/// Identifiers of the frames that the master sends again and again: SYNC, TIME, its heartbeat and
/// RPDOs, those of the pre-defined connection set included (CiA 301, table 39). Of these only the
/// newest is worth sending; a late one is a lie.
std::vector<std::uint32_t> cyclicIdentifiers(const MasterConfig& master);

}  // namespace cia402::canopen
