// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/drive_definition.h"

#include <algorithm>

namespace cia402::sim {

const HomingRoute* DriveHomingDefinition::route(std::int64_t method) const {
  const auto found = routes.find(method);
  return found == routes.end() ? standardRoute(method) : &found->second;
}

const FaultDefinition* DriveDefinition::fault(const std::string& fault_name) const {
  const auto found = std::find_if(faults.begin(), faults.end(),
                                  [&](const FaultDefinition& f) { return f.name == fault_name; });
  return found == faults.end() ? nullptr : &*found;
}

const ObstacleDefinition* DriveDefinition::obstacle(const std::string& obstacle_name) const {
  const auto found =
      std::find_if(obstacles.begin(), obstacles.end(),
                   [&](const ObstacleDefinition& o) { return o.name == obstacle_name; });
  return found == obstacles.end() ? nullptr : &*found;
}

const ModeDefinition* DriveDefinition::mode(std::int64_t number) const {
  const auto found = std::find_if(modes.begin(), modes.end(),
                                  [number](const ModeDefinition& m) { return m.number == number; });
  return found == modes.end() ? nullptr : &*found;
}

}  // namespace cia402::sim
