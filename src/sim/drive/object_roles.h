// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sim/definition/drive_definition.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// What an object of any axis means to the drive; nothing: it only holds its number.
std::optional<Role> roleOf(const DriveDefinition& definition, ObjectId object);
/// How its number stands in it.
Encoding encodingOf(const DriveDefinition& definition, ObjectId object);

}  // namespace cia402::sim
