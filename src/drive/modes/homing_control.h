// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/modes/mode_control.h"

namespace cia402::drive {

/// The drive finds its home by itself (CiA 402-2, homing mode): it takes no set-points.
class HomingControl : public ModeControl {
 public:
  using ModeControl::ModeControl;
  bool accepts(double) const override { return false; }
  std::optional<double> follow(Stream&, Time) override { return {}; }
};

}  // namespace cia402::drive
