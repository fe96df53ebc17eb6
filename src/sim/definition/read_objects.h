// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/definition/reader.h"

namespace cia402::sim {

/// `dictionary:` and `without:`. Objects of the drive that the file extends, if any, go and come
/// one by one.
void readDictionary(DefinitionReader& reader, bool extends, DriveDefinition& out);
/// The `units:` section.
void readUnits(DefinitionReader& reader, DriveDefinition& out);
/// The `units_of:` section, of single objects.
void readUnitsOf(DefinitionReader& reader, DriveDefinition& out);
/// The `polarity:` section.
void readPolarity(DefinitionReader& reader, DriveDefinition& out);
/// `encoding:`, of all objects with a unit.
void readEncoding(DefinitionReader& reader, DriveDefinition& out);
/// `objects:` and `encodings:`, of single objects.
void readObjects(DefinitionReader& reader, DriveDefinition& out);
/// The `memory:` section. @pre the dictionary was read
void readMemory(DefinitionReader& reader, MemoryDefinition& out);

}  // namespace cia402::sim
