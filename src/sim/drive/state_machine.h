// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cia402::sim {

/// States of the power drive system (CiA 402-2, figure of the finite state automaton). Written for
/// the simulator from the standard alone; the driver has its own.
enum class PdsState : std::uint8_t {
  not_ready_to_switch_on,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
};
/// The standard's name, in small letters.
const char* toString(PdsState state);

/// Statusword bits 0-3, 5, 6 of a state (CiA 402-2, table of state coding).
std::uint16_t statusBits(PdsState state);

/// Commands of the controlword (CiA 402-2, table of command coding).
enum class PdsCommand : std::uint8_t {
  none,
  shutdown,
  switch_on,
  enable_operation,
  disable_voltage,
  quick_stop,
  fault_reset,
};

/// The command in `controlword`. Fault reset is the rising edge of bit 7 against `previous`; while
/// bit 7 stays set there is no other command.
PdsCommand decodeCommand(std::uint16_t controlword, std::uint16_t previous);

/// What a state transition asks of the drive before or while it happens.
struct PdsTransition {
  std::uint8_t number = 0;  ///< 0..16 as in the standard; 0 here: no transition
  PdsState to = PdsState::not_ready_to_switch_on;
};

/// The transition that `command` causes in `state`; number 0 when the command means nothing there.
/// Transition 4 after 3 for "switch on and enable operation" (0x0F) is the caller's: it asks again.
PdsTransition transitionFor(PdsState state, PdsCommand command);

}  // namespace cia402::sim
