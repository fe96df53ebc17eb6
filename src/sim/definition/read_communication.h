// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/reader.h"
#include "sim/device/device.h"

namespace cia402::sim {

/// The `communication:` section: switches of DeviceBehaviour by their names.
void readCommunication(DefinitionReader& reader, DeviceBehaviour& out);

}  // namespace cia402::sim
