// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "cia402_driver/common/result.h"

namespace cia402::motion {

/// error_code of control_msgs/FollowJointTrajectoryResult.
enum class TrajectoryErrorCode : std::int32_t {
  successful = 0,
  invalid_goal = -1,
  invalid_joints = -2,
  old_header_timestamp = -3,
  path_tolerance_violated = -4,
  goal_tolerance_violated = -5,
};

/// Why a trajectory was refused: the code for programs, the sentence for people.
struct TrajectoryError : Error {
  TrajectoryError(TrajectoryErrorCode error_code, std::string sentence)
      : Error{std::move(sentence)}, code(error_code) {}

  TrajectoryErrorCode code;
};

}  // namespace cia402::motion
