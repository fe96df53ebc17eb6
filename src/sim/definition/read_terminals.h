// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/definition/reader.h"
#include "sim/definition/terminals.h"

namespace cia402::sim {

/// The section `terminals` of a simulated drive's file.
void readTerminals(DefinitionReader& reader, TerminalsDefinition& out);
/// What such a file says of its digital outputs.
void readOutputs(DefinitionReader& reader, DriveDefinition& out);

}  // namespace cia402::sim
