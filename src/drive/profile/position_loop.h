// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cia402::drive {

/// How the host leads a drive to positions by velocities, where the drive has no mode of operation
/// that follows a stream of positions: velocity = feed_forward * velocity of the set-point + gain *
/// distance to it.
struct PositionLoop {
  double gain = 0.0;          ///< 1/s, > 0; times the cycle at most kLargestStep
  double feed_forward = 1.0;  ///< 0 to 2; 1: the velocity of the set-point is sent as it is

  /// Of the distance to the set-point, what is made good in one cycle at most. What is sent comes
  /// about three cycles later to light in the feedback; from about 0.5 on that would oscillate.
  static constexpr double kLargestStep = 0.1;
};

}  // namespace cia402::drive
