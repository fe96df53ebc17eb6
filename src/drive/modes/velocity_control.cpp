// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/velocity_control.h"

#include <cmath>

namespace cia402::drive {

bool VelocityControl::accepts(double value) const {
  return !(limits().velocity && std::fabs(value) > *limits().velocity) && leadsInside(value);
}

}  // namespace cia402::drive
