// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/procedures/procedure.h"

namespace cia402::drive {

/// Quick stop (transition 11) until the axis stands still, or the power stage is off.
class QuickStopStep {
 public:
  Outcome advance(const Context& context);

 private:
  bool begun_ = false;
  Time started_{};
};

}  // namespace cia402::drive
