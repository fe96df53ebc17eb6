// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/drive/drive.h"

namespace cia402::sim {

/// The object dictionary of a drive at a node, with what identifies it (1018h).
ObjectDictionary buildDictionary(const DriveDefinition& definition, canopen::NodeId node,
                                 const DriveIdentity& identity);

}  // namespace cia402::sim
