// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive_fixture.h"

namespace cia402::sim {

/// In motor turns: limit switches at -2 and 3, home switch from 0.5 to 0.8, index at k + 0.25.
inline AxisMechanics homingMachine(double start) {
  AxisMechanics mechanics;
  mechanics.initial_position = start;
  mechanics.negative_limit_switch = -2.0;
  mechanics.positive_limit_switch = 3.0;
  mechanics.home_switch_low = 0.5;
  mechanics.home_switch_high = 0.8;
  mechanics.index_offset = 0.25;
  return mechanics;
}

}  // namespace cia402::sim
