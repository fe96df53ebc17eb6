// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "drive/profile/profile.h"

namespace cia402::drive {

/// The code of an error (603Fh, or of an emergency) in words: "0x8611 following error: <cause>;
/// <remedy>", from the profile where it knows the code, else by the classes of CiA 301 and 402.
std::string errorCodeText(const DriveProfile& profile, std::uint16_t code);
/// The same for a code that comes without a fault.
std::string warningCodeText(const DriveProfile& profile, std::uint16_t code);

/// What the drive does with the motor in a fault: "; the drive lets the motor coast"; empty: that
/// is not said.
std::string reactionText(const DriveProfile& profile, std::uint16_t code);
/// What a person does next once the cause of a fault is gone: "then clear_faults".
std::string afterwardsText(const DriveProfile& profile, std::uint16_t code);

/// Whether the family says what the code means, alone or as several that stand together in it.
bool knowsCode(const DriveProfile& profile, std::uint16_t code);
/// The short text of a code alone: "following error".
std::string errorName(const DriveProfile& profile, std::uint16_t code);

}  // namespace cia402::drive
