// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/axis/basis.h"
#include "drive/axis/coordinates.h"
#include "drive/axis/position_limits.h"

namespace cia402::drive {

/// Keeps the position limits in the drive (607Dh) with the joint's zero.
class LimitKeeper {
 public:
  /// Both must outlive this.
  LimitKeeper(AxisBasis& axis, const Coordinates& coordinates);

  /// Keeps them open, for the drive is about to get another zero; or no more.
  void open(bool open);
  /// Has them worked out anew: the zero has moved, or the axis is about to be enabled.
  void renew() { due_ = works_ = true; }
  /// The joint's limits are others (AxisConfig).
  void adopt();
  /// Another drive may be there, or the same with other parameters.
  void forget();
  /// The drive has them, or has refused them.
  bool settled() const { return !due_ && limits_.settled(); }
  /// What the drive refused, PositionLimits::problem() and remark().
  std::string problem() const { return limits_.problem(); }
  std::string remark() const { return limits_.remark(); }

  /// To be asked once a cycle, while the device is ready: work() has something to do.
  bool works() const { return works_ || axis_.state.homed != homed_; }
  /// @param target that the axis goes to, rad or m; where it goes to none, its position
  void work(double target);

 private:
  /// Limits belong into the drive: its coordinates are known, and stay.
  bool belong() const { return axis_.state.homed && !open_; }

  AxisBasis& axis_;
  const Coordinates& coordinates_;
  PositionLimits limits_;
  bool due_ = true, open_ = false, known_ = false;
  bool works_ = true, homed_ = false;  ///< as the last work() left them
};

}  // namespace cia402::drive
