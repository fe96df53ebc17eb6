// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/couplings.h"
#include "campaign/families.h"
#include "campaign/random.h"

namespace cia402::campaign {

/// What the author of a history has to know of an axis.
struct AxisPlan {
  std::string name, yaml;
  const Family* family = nullptr;
  bool continuous = false, homing = false, homes_by_moving = false;
  double velocity = 1.0, acceleration = 4.0, effort = 1.0;
  double lower = -1.0, upper = 1.0, at = 0.0;  ///< its range, and where it stands at start
  double turn = 0.0;                           ///< of the motor: from one index pulse to the next
  double command_timeout = 0.2;
  std::string mode;                      ///< at start
  std::optional<std::size_t> neighbour;  ///< the other axis in its drive
  std::optional<std::size_t> mate;       ///< with which it moves joints
};

/// A group of a random robot.
struct GroupPlan {
  std::string name;
  std::vector<std::size_t> axes;
  std::vector<std::string> joints;
  bool partial = false;  ///< it takes trajectories of some of its joints
};

/// A random robot, and what its history must know of it.
struct RobotPlan {
  std::string yaml;
  std::vector<AxisPlan> axes;
  std::vector<CouplingPlan> couplings;
  std::vector<GroupPlan> groups;
};

/// A number with as many digits as a scene needs.
std::string text(double value);

/// A random robot of 2 to 6 axes, now and then with one or two drives of two axes, or with two axes
/// that are a differential or a gantry.
RobotPlan planRobot(Random& random);

}  // namespace cia402::campaign
