// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "cia402_driver/motion/trajectory_error.h"
#include "cia402_driver/motion/trajectory_point.h"
#include "motion/joint.h"
#include "motion/spline.h"

namespace cia402::motion {

/// Where a sentence points to: a joint on its way to a point of the message.
struct Place {
  const Joint& joint;
  std::size_t point;        ///< of the message
  bool from_present_state;  ///< the first segment: it leaves from the commanded state
  double present_position;  ///< of that state
  double begin_s;           ///< the beginning of the segment, counted as time_from_start
  bool behind_end = false;  ///< on the way to rest behind the last point, which is `point`
};

/// Joints, sizes, finite values, times, rest at the end where `rests`; independent of when it
/// begins.
std::optional<TrajectoryError> checkShape(const std::vector<Joint>& joints,
                                          const std::vector<MotionState>& commanded,
                                          const std::vector<TrajectoryPoint>& points,
                                          bool rests = true);

/// Its velocities and accelerations by themselves. @param margin share of the limits by which they
/// may be beyond them
std::optional<TrajectoryError> checkRates(const std::vector<Joint>& joints,
                                          const TrajectoryPoint& point, std::size_t index,
                                          double margin);

/// Numbers that can be computed with, and position limits, over one whole segment.
std::optional<TrajectoryError> checkReach(const SplineSegment& segment, const Place& place);

/// Velocity and acceleration limits over one whole segment.
std::optional<TrajectoryError> checkRates(const SplineSegment& segment, const Place& place);

/// A joint with a limit of acceleration that is to change its velocity by so much at once, on
/// leaving its rest or coming to it.
TrajectoryError jumpOf(const Place& place, bool at_end, double velocity);

}  // namespace cia402::motion
