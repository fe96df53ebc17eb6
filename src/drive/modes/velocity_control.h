// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/modes/mode_control.h"

namespace cia402::drive {

/// Velocities, by cyclic synchronous, profile or velocity mode (CiA 402-2): the drive turns on with
/// the last one.
class VelocityControl : public ModeControl {
 public:
  using ModeControl::ModeControl;
  bool accepts(double value) const override;
};

}  // namespace cia402::drive
