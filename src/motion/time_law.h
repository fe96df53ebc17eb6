// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "motion/joint.h"
#include "motion/spline.h"

namespace cia402::motion {

/// A way of several joints in time as it was asked for: what a TimeLaw slows down.
struct TimedPath {
  /// As many a segment as there are limits; those of one segment have the same duration.
  const std::vector<SplineSegment>& segments;
  /// Of velocity and acceleration, one entry a joint; what is absent is not kept to.
  const std::vector<JointLimits>& limits;
  bool from_rest = true;  ///< else it begins at the velocities of its first segments
};

/// Who is slowed down may not leave its path: a law that tells when each place of a path is passed.
/// Its rate, path seconds a second, is 1 where the path keeps the limits of all joints as it is,
/// and lower around places where it does not; it is chosen as high as these permit, of everything
/// that neither passes 1 nor runs backwards. So all joints stay where they would be together, only
/// later.
///
/// Velocities and accelerations of joints are those of the path under this law. Where a joint with
/// a limit of acceleration leaves its rest, or comes to it, with a velocity on its path, the rate
/// begins or ends with 0.
class TimeLaw {
 public:
  /// As it is asked for.
  TimeLaw() = default;

  /// @return nothing where the path begins in motion and cannot be slowed down in time; allocates
  /// @pre the path is finite, and joints with a limit of acceleration change their velocity
  /// nowhere at once but at its ends
  static std::optional<TimeLaw> of(const TimedPath& path);

  struct Moment {
    double along_s;  ///< place on the path, in s of it
    double rate;     ///< of that, 0 to 1
    double change;   ///< of the rate, 1/s
  };
  /// @param time_s since the beginning; beyond both ends what is there. Does not allocate.
  Moment at(double time_s) const;

  bool asAsked() const { return steps_.empty(); }
  /// How much later than asked the end is reached, s >= 0.
  double delay() const { return delay_s_; }

 private:
  /// The rate changes evenly from the beginning of a step to that of the next.
  struct Step {
    double time_s, along_s, rate, change;
  };

  std::vector<Step> steps_;
  double delay_s_ = 0.0;
};

}  // namespace cia402::motion
