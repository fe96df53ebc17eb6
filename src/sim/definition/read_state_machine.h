// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "sim/definition/drive_definition.h"
#include "sim/definition/reader.h"

namespace cia402::sim {

/// The words for ramps, wherever a file names one.
const std::vector<std::pair<const char*, Ramp>>& rampWords();

/// What option codes do where a file does not say otherwise.
void applyStandardOptions(DriveDefinition& out);
/// The `state_machine:` section.
void readStateMachine(DefinitionReader& reader, DriveDefinition& out);

}  // namespace cia402::sim
