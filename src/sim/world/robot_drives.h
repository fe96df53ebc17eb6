// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/problems.h"
#include "config/robot.h"
#include "sim/drive/drive.h"
#include "sim/world/world.h"

namespace cia402::sim {

/// What it takes to build the simulated drive of one device with its axes.
struct SimulatedDrive {
  std::string name;          ///< of the axis that the configuration names first
  canopen::NodeId node = 0;  ///< 255: none yet
  std::shared_ptr<const DriveDefinition> definition;
  std::vector<AxisMechanics> mechanics;  ///< of its axes 0, 1, ...; at least one
  DriveIdentity identity;
  /// The axes that the configuration names, with their numbers in the drive.
  std::vector<std::pair<std::string, unsigned>> axes;

  std::vector<AxisMechanics> further() const { return {mechanics.begin() + 1, mechanics.end()}; }
};

/// Where the axis of a configuration is among simulated drives.
struct AxisPlace {
  std::size_t drive = 0;  ///< index
  unsigned axis = 0;      ///< in the drive
};
/// @return nothing if no drive has an axis of that name
std::optional<AxisPlace> findAxis(const std::vector<SimulatedDrive>& drives,
                                  const std::string& axis);

/// An axis of a drive that runs; nullptr: none.
struct AxisOfDrive {
  Drive* drive = nullptr;
  unsigned axis = 0;
};

/// Adds them in their order.
void addTo(World& world, const std::vector<SimulatedDrive>& drives);

/// The simulated drives of a robot: definitions from `folder` (config/simulated_drives), mechanics
/// from the axes' geometry and their `simulation:` sections. Problems are added with their paths.
std::vector<SimulatedDrive> simulatedDrives(const config::RobotConfig& robot,
                                            const std::string& folder, Problems& problems);

}  // namespace cia402::sim
