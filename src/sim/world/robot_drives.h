// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/problems.h"
#include "config/robot.h"
#include "sim/drive/drive.h"

namespace cia402::sim {

/// What it takes to build the simulated drive of one axis.
struct SimulatedAxis {
  std::string name;
  canopen::NodeId node = 0;  ///< 255: none yet
  std::shared_ptr<const DriveDefinition> definition;
  AxisMechanics mechanics;
  DriveIdentity identity;
};

/// The simulated drives of a robot: definitions from `folder` (config/simulated_drives), mechanics
/// from the axes' geometry and their `simulation:` sections. Problems are added with their paths.
std::vector<SimulatedAxis> simulatedAxes(const config::RobotConfig& robot,
                                         const std::string& folder, Problems& problems);

}  // namespace cia402::sim
