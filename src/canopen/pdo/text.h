// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "canopen/pdo/image.h"

namespace cia402::canopen {

/// "TPDO 1 (COB-ID 0x183)".
std::string pdoName(const PdoImage::Pdo& pdo);
/// The TPDOs that are overdue: "TPDO 1 (COB-ID 0x183) did not come for 11 cycles"; empty if none.
std::string staleText(const PdoImage& image);
/// The same without numbers that grow: "TPDO 1 (COB-ID 0x183) does not come", "TPDO 2 (COB-ID
/// 0x283) comes too short (3 bytes instead of 8)"; empty if none is overdue.
std::string missingText(const PdoImage& image);
/// The TPDOs that came with a wrong length: "TPDO 2 (COB-ID 0x283) came with 3 bytes instead of 8:
/// too short, not taken (17 so far)"; empty if none.
std::string wrongLengthText(const PdoImage& image);

}  // namespace cia402::canopen
