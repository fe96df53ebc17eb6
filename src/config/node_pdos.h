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

/// Nothing of the node travels by PDO: what its PDOs would carry becomes NodeConfig::by_sdo.
/// @param bitrate bit/s
void carryBySdo(double bitrate, canopen::NodeConfig& node);

/// Gives TPDOs of every n-th SYNC that may begin with any SYNC their turns, with a SYNC counter.
void assignSyncStarts(canopen::MasterConfig& master);

}  // namespace cia402::config
