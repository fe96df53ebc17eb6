// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "canopen/eds/eds.h"
#include "canopen/eds/entry.h"
#include "canopen/eds/keys.h"
#include "canopen/eds/problems.h"
#include "canopen/eds/sections.h"

// What CiA 306 lets a file leave out.
namespace cia402::canopen {

/// Sub-index 0 of an object whose sub-indices are implied: read-only, `count` of them.
DictionaryEntry edsCountEntry(std::uint16_t index, const char* name, std::uint8_t count);

/// Gives the sub-indices of compact objects the names, denotations and values that the file lists
/// for them ([1018Name] and the like).
void readEdsCompactLists(const EdsSections& sections, EdsEntryReader& entries, EdsKeys& keys,
                         EdsProblems& problems, ObjectDictionary& dictionary);

/// Adds the parameters of the PDOs that [DeviceInfo] counts but no section describes, with the
/// sub-indices that CompactPDO names.
void addEdsCompactPdos(const EdsInfo& info, ObjectDictionary& dictionary);

}  // namespace cia402::canopen
