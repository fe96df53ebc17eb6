// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/maker_states.h"
#include "sim/dictionary/object_dictionary.h"

namespace cia402::sim {

/// Shows in the maker's own object, if there is one, what the statusword says, and that the motor
/// has power, which in a maker's own mode it does not say.
inline void showMakerState(const MakerStates& states, std::uint16_t statusword, bool powered,
                           ObjectDictionary& dictionary) {
  Entry* entry = states.object ? dictionary.find(*states.object) : nullptr;
  if (entry == nullptr) return;
  constexpr unsigned kFault = 0x08, kAnyState = 0x4F;
  const bool faulted = (statusword & kFault) != 0, starts = (statusword & kAnyState) == 0;
  entry->number = static_cast<std::uint64_t>(faulted   ? states.fault
                                             : powered ? states.running
                                             : starts  ? states.not_ready
                                                       : states.ready);
}

}  // namespace cia402::sim
