// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "drive/profile/profile.h"

namespace cia402::drive {

/// Does an axis give this object its value in every cycle: controlword, mode, targets of modes, and
/// what is held there while a mode is active?
bool isSetByAxis(const DriveProfile& profile, const std::string& object);
/// Does it hold digital outputs alone, which people set: it may travel in the cycle, and holds 0
/// until somebody has.
bool isSetByPeople(const DriveProfile& profile, const std::string& object);
/// Is it set in no cycle of an axis that can be in these modes? An RPDO carries it as the drive
/// holds it, or as it was written last.
bool isKept(const DriveProfile& profile, const std::vector<std::string>& modes,
            const std::string& object);

}  // namespace cia402::drive
