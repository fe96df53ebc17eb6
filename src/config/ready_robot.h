// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "config/robot.h"

namespace cia402::config {

/// What a driver may be started with: a configuration without a mistake.
struct ReadyRobot {
  RobotConfig robot;
  canopen::MasterConfig master;
};

/// loadRobot() and makeMasterConfig(). Where there is any problem it is added, all of the first
/// before those that only the second can see, and there is no robot: who has none can send no
/// frame.
std::optional<ReadyRobot> readyRobot(const YAML::Node& tree, const ProfileLookup& profiles,
                                     Problems& problems);

}  // namespace cia402::config
