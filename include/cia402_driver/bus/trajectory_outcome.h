// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>

#include "cia402_driver/motion/trajectory_error.h"

namespace cia402::bus {

/// How a trajectory came to its end.
enum class TrajectoryEnd : std::uint8_t {
  reached,   ///< its goal, within the tolerances where there are some
  replaced,  ///< a newer one took over, or was accepted before this one began
  stopped,   ///< by an empty trajectory, by halt, quick_stop or disable of one of its joints, by
             ///< what stops all motion, or by the end of the program
  refused,   ///< it was never followed
  failed,    ///< a joint left its path, fell out of operation, or missed the goal
};

/// What a trajectory came to, with the code of control_msgs/FollowJointTrajectoryResult.
struct TrajectoryOutcome {
  motion::TrajectoryErrorCode code = motion::TrajectoryErrorCode::successful;
  std::string message;  ///< a sentence
  TrajectoryEnd end = TrajectoryEnd::reached;
  std::string joint{};  ///< whose fault it is, or which is farthest from its goal; empty: none
  double off =
      std::numeric_limits<double>::quiet_NaN();  ///< by how much, rad or m; NaN: by nothing
  std::size_t passed_points = 0;  ///< of one accepted with a start time: what it begins behind
  bool slowed = false;  ///< of one accepted: it takes longer than asked, to keep the limits
};

/// Told once how a trajectory that was accepted ended, in the bus thread; may be empty. Must not
/// block.
using TrajectoryEnded = std::function<void(const TrajectoryOutcome&)>;

}  // namespace cia402::bus
