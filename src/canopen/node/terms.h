// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fieldbus/terms.h"

namespace cia402::canopen {

/// The words of CiA 301.
inline constexpr fieldbus::Terms kTerms = {
    "node",
    "node-ID or bit rate",
    "PDO",
    "TPDO",
    "RPDO",
    "SDO",
    "EMCY",
    "NMT stop and start",
    "no RPDO reached it in time (1400:05)",
    "the bus and the COB-IDs of its RPDOs",
};

}  // namespace cia402::canopen
