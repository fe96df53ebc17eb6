// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "canopen/config.h"

namespace cia402::canopen {

/// Identifiers of which only the newest frame of the master is worth sending, for a late one is a
/// lie: SYNC, TIME, heartbeat, RPDOs. A drive may keep COB-IDs for its PDOs that are known only
/// once it has booted; hence all but those of NMT, SDO and LSS requests.
std::vector<std::uint32_t> cyclicIdentifiers(const MasterConfig& master);

}  // namespace cia402::canopen
