// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "drive/profile/disabling.h"

namespace cia402::drive {

/// States of the CiA 402 power drive system (CiA 402-2, finite state automaton).
enum class State : std::uint8_t {
  not_ready_to_switch_on,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
  unknown,  ///< no statusword yet, or bits that match no state
};
/// "operation enabled".
const char* toString(State state);
/// The power stage is off in this state: no motion is possible by this drive. In a fault that shows
/// bits of operation beside it (0x0009) nobody knows.
bool powerStageOff(State state, std::uint16_t statusword);
/// "fault", or the drive still reacts to one.
inline bool isFault(State state) {
  return state == State::fault || state == State::fault_reaction_active;
}

/// The state that a statusword shows, by mask and value as CiA 402-2 lists them; with bit 3 (fault)
/// set and other bits of no state it is a fault.
State decodeState(std::uint16_t statusword);

/// Where somebody wants the drive to be.
enum class Goal : std::uint8_t { disabled, ready, switched_on, enabled, quick_stop };

/// One step towards a goal from a state: bits of the controlword 0..3 and 7.
struct Command {
  std::uint16_t controlword = 0;
  int transition = -1;    ///< number in CiA 402-2; -1: nothing to do, wait
  const char* text = "";  ///< "shutdown (transition 2)"
};
/// The controlword that brings `state` one transition nearer to `goal` or keeps it there; a table
/// over all states and goals. Fault is only left by a fault reset, never by this.
/// @param disabling by which transitions the goal "disabled" is gone to
Command nextCommand(State state, Goal goal, const Disabling& disabling = {});

namespace controlword {
inline constexpr std::uint16_t kSwitchOn = 1u << 0, kEnableVoltage = 1u << 1, kQuickStop = 1u << 2,
                               kEnableOperation = 1u << 3, kHomingStart = 1u << 4,
                               kFaultReset = 1u << 7, kHalt = 1u << 8;
/// The command "quick stop": the voltage stays, the bit that is named after it is 0.
inline constexpr std::uint16_t kQuickStopCommand = kEnableVoltage;
}  // namespace controlword
namespace statusword {
inline constexpr std::uint16_t kVoltageEnabled = 1u << 4, kWarning = 1u << 7, kRemote = 1u << 9,
                               kTargetReached = 1u << 10, kInternalLimit = 1u << 11;
}

}  // namespace cia402::drive
