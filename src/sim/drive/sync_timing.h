// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/drive/motion_limits.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// The interpolation period that is configured (60C2h), s; 0: none.
double interpolationPeriod(const DriveValues& values);
/// By how much SYNC may be off in a mode, s; kUnlimited where the drive does not mind.
/// @param mode nullptr: none, or it is not enabled
double syncTolerance(const DriveDefinition& definition, const DriveValues& values,
                     const ModeDefinition* mode);

}  // namespace cia402::sim
