// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/drive/moving_axis.h"
#include "sim/drive/profile_position.h"

namespace cia402::sim {

/// A condition that must hold for some time before it counts (windows of CiA 402).
class HeldCondition {
 public:
  /// One step. @return whether `condition` has held for `seconds` now.
  bool step(bool condition, double seconds) {
    held_s_ = condition ? held_s_ + kDriveStepS : 0.0;
    return condition && held_s_ > seconds;
  }
  /// Has not held so far.
  void reset() { held_s_ = 0.0; }

 private:
  double held_s_ = 0.0;
};

/// The windows of CiA 402-2: following error (6065h), targets reached (6067h, 606Dh), standstill
/// (606Fh), each with its time.
class TargetSupervision {
 public:
  explicit TargetSupervision(MovingAxis& axis) : axis_(axis) {}

  /// The power stage was switched: no following error yet.
  void restart();
  /// A mode or a set-point has begun: nothing is reached yet.
  void newTarget();
  /// As newTarget(), and speeds are judged anew.
  void newMode();
  /// One kDriveStep. `controlled`: by position. `halted`: a target is reached by standing still.
  void step(bool controlled, bool halted, const ProfilePosition& set_points);

  bool followingErrorExceeded() const { return following_error_; }
  bool targetReached() const { return target_reached_; }
  bool atZeroSpeed() const { return at_zero_speed_; }

 private:
  void superviseFollowing(bool controlled);
  bool reached(bool halted, const ProfilePosition& set_points);
  bool torqueReached();

  MovingAxis& axis_;
  HeldCondition following_, position_reached_, velocity_reached_, zero_speed_;
  bool following_error_ = false;
  bool target_reached_ = false;
  bool at_zero_speed_ = true;
  bool torque_above_ = false;
};

}  // namespace cia402::sim
