// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/standstill.h"

#include <cmath>

namespace cia402::drive {

void Standstill::update(double position, Time stamp) {
  const bool moved = !(std::fabs(position - anchor_) <= tolerance_);
  if (started_ && !moved && stamp - anchored_ < kWindow) return;
  if (started_) {
    still_ = !moved;
    moving_ = moved;
    if (still_) still_from_ = anchored_;
  }
  started_ = true;
  anchor_ = position;
  anchored_ = stamp;
}

void Standstill::reset() { started_ = still_ = moving_ = false; }

}  // namespace cia402::drive
