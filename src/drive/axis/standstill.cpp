// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/standstill.h"

namespace cia402::drive {

/// A window is over, or the axis has left it: the next one begins here.
void Standstill::anchor(double position, Time stamp, bool moved) {
  if (started_) {
    still_ = !moved;
    moving_ = moved;
    if (still_) still_from_ = anchored_;
    velocity_ = (position - anchor_) / toSeconds(stamp - anchored_);
  }
  started_ = true;
  anchor_ = position;
  anchored_ = stamp;
}

void Standstill::reset() {
  started_ = still_ = moving_ = false;
  velocity_ = std::numeric_limits<double>::quiet_NaN();
}

}  // namespace cia402::drive
