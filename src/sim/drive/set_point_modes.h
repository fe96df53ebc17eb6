// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/drive/moving_axis.h"

namespace cia402::sim {

// The modes that remember nothing but the demand: one kDriveStep each.

/// Cyclic synchronous position: along the interpolated targets.
void stepCyclicPosition(MovingAxis& axis);
/// 60FFh; `ramped`: by 6083h and 6084h (profile velocity), else at once (cyclic synchronous).
void stepVelocity(MovingAxis& axis, bool ramped);
/// 6071h; `ramped`: by 6087h (profile torque), else at once (cyclic synchronous).
void stepTorque(MovingAxis& axis, bool ramped);
/// No mode assigned: slows down by 6084h and stands.
void stepHold(MovingAxis& axis);

}  // namespace cia402::sim
