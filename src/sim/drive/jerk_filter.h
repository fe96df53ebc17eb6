// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

namespace cia402::sim {

/// Makes the corners of a trapezoidal velocity profile round (6086h = 3): the mean of its positions
/// over some time. Where that time is an acceleration over a jerk, no change of that acceleration
/// has more than this jerk, and the profile ends where it did, so much later.
class JerkFilter {
 public:
  /// Stands here.
  void reset(double position);
  /// How long corners take, s.
  void limit(double seconds);
  /// One kDriveStep. @param position of the profile @return the round one
  double step(double position);

 private:
  std::deque<double> positions_{0.0};  ///< of the last steps
  double last_ = 0.0;
};

}  // namespace cia402::sim
