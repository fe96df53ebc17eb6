// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "can/socketcan.h"
#include "config/robot.h"

namespace cia402 {

/// The interface of the kernel that a robot is on: cyclic frames are never sent late, and what
/// nobody needs is not received. One that is missing or down is waited for.
std::unique_ptr<can::SocketCan> openSocket(const config::BusConfig& bus,
                                           const canopen::MasterConfig& master);

}  // namespace cia402
