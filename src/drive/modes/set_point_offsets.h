// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/axis/basis.h"

namespace cia402::drive {

/// The offsets of a cyclic mode (60B1h, 60B2h), made of the set-point's velocity and acceleration
/// (FeedForward). 0 wherever the set-point rests or the mode is not active.
class SetPointOffsets {
 public:
  /// Both must outlive it.
  SetPointOffsets(const ModeChannel& channel, AxisBasis& axis)
      : axis_(axis), velocity_(channel.velocity_offset), torque_(channel.torque_offset) {}

  /// One of them travels.
  bool any() const { return velocity_.output.mapped() || torque_.output.mapped(); }
  /// Of the set-point of this cycle. @param velocity of it, rad/s or m/s
  [[gnu::cold]] void set(double velocity);  // few axes have offsets: kept out of every cycle's code
  [[gnu::cold]] void clear();

 private:
  void put(const ModeChannel::Offset& offset, double value);

  AxisBasis& axis_;
  const ModeChannel::Offset &velocity_, &torque_;
  double before_ = 0.0;  ///< the set-point's velocity in the last cycle
};

}  // namespace cia402::drive
