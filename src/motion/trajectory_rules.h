// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cia402::motion {

/// What becomes of a trajectory that asks for more than its joints may do on the way. What its
/// points say themselves must keep the limits in any case, and positions always.
struct TrajectoryRules {
  /// It is refused. Else it is slowed down along its path where it is beyond a limit of velocity or
  /// acceleration, all joints together, and as much as has to be.
  bool strict = true;
  double margin = 0.0;  ///< share of the limits of acceleration by which it may be beyond them
  /// It ends no later than asked by this share of its duration and so many seconds, or is refused.
  double longer_share = 0.0, longer_s = 0.0;
  /// As streams of commands have it: it may end in motion, and one with a single point ahead takes
  /// the time that it needs for it.
  bool streamed = false;
  /// How long it goes on at the velocity with which it ends, before it is brought to rest.
  double coast_s = 0.0;
};

}  // namespace cia402::motion
