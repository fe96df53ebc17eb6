// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "cia402_driver/bus/trajectory_outcome.h"
#include "config/robot.h"
#include "motion/trajectory.h"

namespace cia402::bus {

/// Who waits for the end of a trajectory, and how closely that is to be followed.
struct TrajectoryOrder {
  std::uint64_t id = 0;  ///< by which it is cancelled; 0: by nobody
  TrajectoryEnded ended;
  std::map<std::string, config::JointTolerance> tolerances;  ///< by the names of joints; else none
  double goal_time = 0.0;                                    ///< s

  /// Tells who waits, once; afterwards nobody waits any more, and nobody cancels it.
  void tell(const TrajectoryOutcome& outcome);
};

/// The same points with the values in another order. @param places for each value its place in the
/// points
std::vector<motion::TrajectoryPoint> reorder(const std::vector<motion::TrajectoryPoint>& points,
                                             const std::vector<std::size_t>& places);

}  // namespace cia402::bus
