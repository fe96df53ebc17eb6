// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/device/sdo/channel.h"

namespace cia402::sim {

/// The CRC of the channel's data as the device computes it (CiA 301, 7.2.4.3.17). A device with a
/// wrong CRC sends it, and finds its own different from the client's.
std::uint16_t sdoBlockCrc(const SdoChannel& channel);

}  // namespace cia402::sim
