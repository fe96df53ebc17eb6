// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/quirks.h"
#include "sim/definition/reader.h"

namespace cia402::sim {

/// The `quirks:` section.
void readQuirks(DefinitionReader& reader, DriveQuirks& out);

}  // namespace cia402::sim
