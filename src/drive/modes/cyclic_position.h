// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/modes/position_control.h"

namespace cia402::drive {

/// Positions, a new one each cycle (cyclic synchronous and interpolated position mode, CiA 402-2):
/// the drive stands at the last one.
class CyclicPosition : public PositionControl {
 public:
  using PositionControl::PositionControl;
};

}  // namespace cia402::drive
