// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

#include "cia402_driver/common/time.h"

namespace cia402::drive {

/// Tells from measured positions whether an axis stands still: its mean velocity over a window must
/// stay below the threshold. Positions do not lie as drives' velocity values do (rpm steps, noise,
/// not mapped at all).
class Standstill {
 public:
  static constexpr Duration kWindow{std::chrono::milliseconds(50)};

  /// @param threshold rad/s or m/s, > 0
  /// @param resolution rad or m per device unit: one unit to and fro is no motion
  Standstill(double threshold, double resolution)
      : tolerance_(threshold * toSeconds(kWindow) + 1.5 * resolution) {}

  /// Takes a measured position (rad or m) with the time it was on the wire.
  void update(double position, Time stamp) {
    const bool moved = !(std::fabs(position - anchor_) <= tolerance_);
    if (moved || !started_ || stamp - anchored_ >= kWindow) anchor(position, stamp, moved);
  }
  /// Nothing is known any more: counts as moving until a window is full again.
  void reset();
  bool still() const { return still_; }
  /// Beginning of the last window in which it stood. @pre still()
  Time stillFrom() const { return still_from_; }
  /// Has been seen to move; false, too, while a first window is not full yet.
  bool moving() const { return moving_; }
  /// Mean over the last window, or until it was left, rad/s or m/s; NaN before there was one.
  double velocity() const { return velocity_; }
  /// Two places no farther apart are one, rad or m.
  double tolerance() const { return tolerance_; }

 private:
  void anchor(double position, Time stamp, bool moved);

  double tolerance_;  ///< rad or m within a window
  double anchor_ = 0.0;
  double velocity_ = std::numeric_limits<double>::quiet_NaN();
  Time anchored_{}, still_from_{};
  bool started_ = false, still_ = false, moving_ = false;
};

}  // namespace cia402::drive
