// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace cia402::motion {

/// What a joint moves in; only used to write sentences.
enum class JointUnit { radian, metre };

/// "rad" or "m".
const char* toString(JointUnit unit);

/// The limits of one joint, in rad or m and their derivatives, N·m or N. An absent limit is not
/// checked. `lower` and `upper` hold for continuous joints, too, where they are given.
struct JointLimits {
  std::optional<double> lower, upper;
  std::optional<double> velocity, acceleration, jerk, effort;  ///< largest magnitudes, > 0
  bool continuous = false;  ///< turns without end: positions a full turn apart are one pose
};

/// The position nearest to `wanted` that a joint may go to from where it is: between its limits;
/// from outside of them only back, and no further than it is told.
double withinReach(const JointLimits& limits, double wanted, double from);
/// From `position` to the limit of position that it moves to: negative beyond that, infinity where
/// there is none. @param velocity 0 counts as one towards `lower`
double room(const JointLimits& limits, double position, double velocity);

/// One joint as the motion module sees it.
struct Joint {
  std::string name;
  JointLimits limits;
  JointUnit unit = JointUnit::radian;
  double deceleration = 5.0;  ///< > 0, with which it is brought to rest without a limit, per s^2
};

/// Position, velocity and acceleration of one joint, in rad or m and s.
struct MotionState {
  double position = 0, velocity = 0, acceleration = 0;
};

/// A number for a sentence, up to 8 significant digits: "3.1", "-0.25".
std::string formatNumber(double value);
/// The same with its unit: "0.1 rad".
std::string lengthText(double value, JointUnit unit);

}  // namespace cia402::motion
