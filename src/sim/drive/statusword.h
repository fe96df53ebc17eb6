// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/definition/quirks.h"
#include "sim/drive/state_machine.h"

namespace cia402::sim {

/// What a statusword (6041h, CiA 402-2) is made of.
struct StatuswordParts {
  PdsState shown = PdsState::not_ready_to_switch_on;  ///< the state that it shows
  bool ready = false;                                 ///< the initialisation is over
  bool voltage = true;                                ///< bit 4
  bool remote = true;                                 ///< bit 9
  bool warning = false;                               ///< bit 7
  std::uint16_t of_mode = 0;  ///< bits 10 to 13 and 15, while enabled; and that home was found
};

/// The statusword of these parts, with what the drive does to it otherwise. Bits that mean nothing
/// to anybody but the maker change as they like: here every 10 ms.
std::uint16_t makeStatusword(const StatuswordParts& parts, const DriveQuirks& quirks, Time now);

}  // namespace cia402::sim
