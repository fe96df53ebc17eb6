// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cia402_driver/common/time.h"

namespace cia402::motion {

/// One point as in trajectory_msgs/JointTrajectoryPoint: rad or m and their derivatives, one number
/// a joint. Velocities and accelerations may be absent; accelerations need velocities.
struct TrajectoryPoint {
  std::vector<double> positions, velocities, accelerations;
  Duration time_from_start{};
};

}  // namespace cia402::motion
