// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "canopen/eds/eds.h"
#include "canopen/eds/keys.h"
#include "canopen/eds/problems.h"
#include "canopen/eds/sections.h"
#include "canopen/eds/text.h"

namespace cia402::canopen {

/// Compares [MandatoryObjects], [OptionalObjects] and [ManufacturerObjects], what objects the
/// device is said to have, with those that are described. What is described but not listed is taken
/// over all the same. @param full some objects may be missing in `dictionary` for want of room
void checkEdsLists(const EdsText& text, const EdsSections& sections, EdsKeys& keys,
                   EdsProblems& problems, const ObjectDictionary& dictionary, bool full);

}  // namespace cia402::canopen
