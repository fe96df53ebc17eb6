// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "canopen/sdo/client.h"

namespace cia402::canopen {

/// "1018:01 vendor id".
std::string objectText(ObjectId object, const std::string& name);
/// Up to eight bytes as one number: "0x0064" for 64 00; longer data as "12 bytes".
std::string valueText(const Bytes& data);
/// What to look at where a drive is heard and its SDO server is not.
inline constexpr const char* kMuteAdvice =
    "its SDO server is mute; look at the COB-IDs of that server (1200h in the drive, `sdo` in the "
    "configuration), for another SDO client (a maker's tool) or a second device with this node-ID, "
    "and whether the drive is still starting up";

}  // namespace cia402::canopen
