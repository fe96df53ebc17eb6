// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/definition/reader.h"

namespace cia402::sim {

/// One of the `faults:`. Replaces a fault of that name.
/// @param parent the section that they lie in, for the path.
void readFault(const std::string& name, const YAML::Node& node, DefinitionReader& parent,
               DriveDefinition& out);

}  // namespace cia402::sim
