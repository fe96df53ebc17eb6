// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cia402_driver/campaign/scene.h"
#include "robot_plan.h"

namespace cia402::campaign {

/// A random history of a robot: it is set in motion again and again, and while it moves, people
/// call services in quick succession and things go wrong.
std::vector<Action> planHistory(Random& random, const RobotPlan& robot, double seconds);

}  // namespace cia402::campaign
