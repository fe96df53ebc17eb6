// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cia402::drive {

class AxisCore;

/// What tells, after home was found, that the drive takes its home offset (607Ch) otherwise than
/// the axis reckons; empty where nothing does. @param written the driver wrote it
/// @param moves the method does
std::string offsetProblem(const AxisCore& axis, bool written, bool moves);

}  // namespace cia402::drive
