// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/bus/trajectory_outcome.h"
#include "motion/trajectory.h"

namespace cia402::bus {

/// How closely a trajectory is to be followed, other than the group's configuration has it.
struct TrajectoryTolerances {
  /// Of a joint, rad or m. Absent: as the group has it; 0: none.
  struct OfJoint {
    std::optional<double> trajectory, goal;
  };
  std::map<std::string, OfJoint> joints;  ///< by name
  std::optional<double> goal_time;        ///< s >= 0
};

/// Who waits for the end of a trajectory, and how closely that is to be followed.
struct TrajectoryOrder {
  std::uint64_t id = 0;  ///< by which it is cancelled; 0: by nobody
  TrajectoryEnded ended;
  TrajectoryTolerances tolerances;

  /// Tells who waits, once; afterwards nobody waits any more, and nobody cancels it.
  void tell(const TrajectoryOutcome& outcome);
};

/// The same points with the values in another order. @param places for each value its place in the
/// points
std::vector<motion::TrajectoryPoint> reorder(const std::vector<motion::TrajectoryPoint>& points,
                                             const std::vector<std::size_t>& places);

}  // namespace cia402::bus
