// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/drive/moving_axis.h"

namespace cia402::sim {

// The modes that remember nothing but the demand: one kDriveStep each.

/// 60FFh; `ramped`: by 6083h and 6084h (profile velocity), else at once (cyclic synchronous).
void stepVelocity(MovingAxis& axis, bool ramped);
/// Bits 4 to 6 of the controlword in velocity mode.
struct VelocityModeBits {
  bool ramped = false;     ///< enable ramp; else the velocity steps
  bool unlocked = false;   ///< unlock ramp; else the present velocity is kept
  bool reference = false;  ///< reference ramp; else it is to be 0
};
/// 6042h (velocity mode, CiA 402-2), between the amounts of 6046h, by the ramps 6048h and 6049h.
void stepVelocityMode(MovingAxis& axis, const VelocityModeBits& bits);
/// 6071h; `ramped`: by 6087h (profile torque), else at once (cyclic synchronous).
void stepTorque(MovingAxis& axis, bool ramped);
/// Torque is let go by 6087h.
void stepFading(MovingAxis& axis);
/// No mode assigned: slows down by 6084h and stands.
void stepHold(MovingAxis& axis);

}  // namespace cia402::sim
