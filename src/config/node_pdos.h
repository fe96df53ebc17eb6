// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "canopen/config.h"
#include "canopen/device_config.h"
#include "common/problems.h"
#include "drive/axis/config.h"

// The PDOs that the master needs, of what axes and devices say.
namespace cia402::config {

/// Adds the PDOs of an axis: those of its layout, and all others that it has as such that are to be
/// disabled. Those beyond the predefined connection set to which nobody gave a COB-ID wait for
/// assignCobIds().
void addPdos(const drive::AxisConfig& axis, const canopen::DeviceConfig& device,
             canopen::NodeConfig& node, Problems& problems);

/// Gives COB-IDs to those that wait for one: such as the node has in the predefined connection set
/// and does not use, then such as no device has by default (680h to 6DFh).
void assignCobIds(canopen::MasterConfig& master, Problems& problems);

/// No two PDOs on the bus share an identifier: a drive would take what is meant for another.
void checkCobIds(const canopen::MasterConfig& master, Problems& problems);

}  // namespace cia402::config
