// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/definition/reader.h"

namespace cia402::sim {

/// Reads `homing` of the file of a simulated drive.
void readHoming(DefinitionReader& reader, DriveHomingDefinition& out);

}  // namespace cia402::sim
