// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace cia402::drive {

/// By which transitions of CiA 402-2 a drive is taken from operation enabled to switch on disabled,
/// once its motor stands. From ready to switch on it is transition 7 always.
struct Disabling {
  int from_operation = 5;     ///< 5 disable operation, 8 shutdown, 9 disable voltage
  int from_switched_on = 10;  ///< 6 shutdown, 10 disable voltage

  /// In their order, from operation enabled on: 5 and 10; 5, 6 and 7; 8 and 7; 9.
  std::vector<int> transitions() const {
    if (from_operation == 9) return {9};
    if (from_operation == 8) return {8, 7};
    return from_switched_on == 6 ? std::vector<int>{5, 6, 7} : std::vector<int>{5, 10};
  }
};

}  // namespace cia402::drive
