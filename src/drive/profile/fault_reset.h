// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cia402_driver/common/time.h"

namespace cia402::drive {

/// What a family takes to forget a fault.
struct FaultReset {
  int tries = 1;  ///< edges of controlword bit 7 that it may take, 1 to 20
  /// Where these did not help the device is taken out of operation for so long, and resets once
  /// more; 0: it is not.
  Duration pause{0};
  /// An object that takes faults away where these did not, by a 1; empty: there is none.
  std::string object;
  bool clears_history = false;  ///< 1003h:00 = 0 is written before
};

}  // namespace cia402::drive
