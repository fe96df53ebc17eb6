// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/definition/reader.h"

namespace cia402::sim {

/// One of the `faults:`. Replaces a fault of that name.
void readFault(const std::string& name, const yaml::Value& from, DriveDefinition& out);

/// One of the `fault_records:`.
void readFaultRecord(const yaml::Value& from, DriveDefinition& out);

/// One of the `obstacles:`.
void readObstacle(const std::string& name, const yaml::Value& from, DriveDefinition& out);

}  // namespace cia402::sim
