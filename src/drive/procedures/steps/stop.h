// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/procedures/procedure.h"

namespace cia402::drive {

/// Quick stop (transition 11) until the axis stands still, or the power stage is off. What turns in
/// a mode that another one brakes (StopBy::mode) is braked by that first: the quick stop of such a
/// mode may do no more than let the torque go.
class QuickStopStep {
 public:
  Outcome advance(const Context& context);

 private:
  void begin(const Context& context);
  bool brakes(const Context& context) const;

  bool begun_ = false, brakes_ = false;
  Time started_{};
};

}  // namespace cia402::drive
