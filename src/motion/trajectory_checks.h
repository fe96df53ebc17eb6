// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "motion/trajectory.h"

namespace cia402::motion {

/// Where a sentence points to: a joint on its way to a point of the message.
struct Place {
  const Joint& joint;
  std::size_t point;
  bool from_present_state;  ///< the first segment: it leaves from the commanded state
  double present_position;  ///< of that state
  double begin_s;           ///< the beginning of the segment, counted as time_from_start
};

/// Joints, sizes, finite values, times, rest at the end; independent of when it begins.
std::optional<TrajectoryError> checkShape(const std::vector<Joint>& joints,
                                          const std::vector<MotionState>& commanded,
                                          const std::vector<TrajectoryPoint>& points);

/// Position, velocity and acceleration limits over one whole segment.
std::optional<TrajectoryError> checkLimits(const SplineSegment& segment, const Place& place);

}  // namespace cia402::motion
