// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/robot_plan.h"
#include "campaign/scene.h"

namespace cia402::campaign {

/// A random history of a robot: it is set in motion again and again, and while it moves, people
/// call services in quick succession and things go wrong.
std::vector<Action> planHistory(Random& random, const RobotPlan& robot, double seconds);

}  // namespace cia402::campaign
