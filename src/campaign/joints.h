// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "campaign/stage.h"

namespace cia402::campaign {

/// The joints of a robot; `axes` are told what they move together.
std::vector<JointFacts> jointsOf(const config::RobotConfig& robot, std::vector<AxisFacts>& axes);

}  // namespace cia402::campaign
