// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/definition/reader.h"

namespace cia402::sim {

/// One of the `modes:`: what a value of 6060h makes the drive do. Replaces a mode of that number.
/// @param parent the section that they lie in, for what is wrong with the number.
void readMode(const std::string& number, const yaml::Value& from, DefinitionReader& parent,
              DriveDefinition& out);

}  // namespace cia402::sim
