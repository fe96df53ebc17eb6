// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>

#include "canopen/config.h"

namespace cia402::canopen {

/// 11-bit identifiers (CiA 301, 7.3.5; CiA 305) that a master with this configuration has to hear:
/// the services of all nodes but their PDOs, and the PDOs of the configured nodes, both ways, for
/// who else commands them is another master. All of them where a drive is to keep COB-IDs of its
/// own for its PDOs, which only its boot tells.
std::bitset<2048> receivedIdentifiers(const MasterConfig& master);

}  // namespace cia402::canopen
