// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/state_machine.h"

namespace cia402::sim {
namespace {

using S = PdsState;
using C = PdsCommand;

struct CommandCoding {
  std::uint16_t mask;
  std::uint16_t value;
  PdsCommand command;
};

// Bits 7, 3, 2, 1, 0. "Disable operation" (transition 5) has the coding of "switch on".
constexpr CommandCoding kCommands[] = {{0x0082, 0x0000, C::disable_voltage},
                                       {0x0086, 0x0002, C::quick_stop},
                                       {0x0087, 0x0006, C::shutdown},
                                       {0x008F, 0x0007, C::switch_on},
                                       {0x008F, 0x000F, C::enable_operation}};

struct Row {
  std::uint8_t number;
  PdsState from;
  PdsCommand command;
  PdsState to;
};

// Transitions 0, 1, 12 (when the quick stop has ended), 13 and 14 are automatic.
constexpr Row kTransitions[] = {
    {2, S::switch_on_disabled, C::shutdown, S::ready_to_switch_on},
    {3, S::ready_to_switch_on, C::switch_on, S::switched_on},
    {3, S::ready_to_switch_on, C::enable_operation, S::switched_on},
    {4, S::switched_on, C::enable_operation, S::operation_enabled},
    {5, S::operation_enabled, C::switch_on, S::switched_on},
    {6, S::switched_on, C::shutdown, S::ready_to_switch_on},
    {7, S::ready_to_switch_on, C::quick_stop, S::switch_on_disabled},
    {7, S::ready_to_switch_on, C::disable_voltage, S::switch_on_disabled},
    {8, S::operation_enabled, C::shutdown, S::ready_to_switch_on},
    {9, S::operation_enabled, C::disable_voltage, S::switch_on_disabled},
    {10, S::switched_on, C::quick_stop, S::switch_on_disabled},
    {10, S::switched_on, C::disable_voltage, S::switch_on_disabled},
    {11, S::operation_enabled, C::quick_stop, S::quick_stop_active},
    {12, S::quick_stop_active, C::disable_voltage, S::switch_on_disabled},
    {15, S::fault, C::fault_reset, S::switch_on_disabled},
    {16, S::quick_stop_active, C::enable_operation, S::operation_enabled}};

}  // namespace

const char* toString(PdsState state) {
  constexpr const char* kNames[] = {
      "not ready to switch on", "switch on disabled", "ready to switch on",    "switched on",
      "operation enabled",      "quick stop active",  "fault reaction active", "fault"};
  return kNames[static_cast<std::uint8_t>(state)];
}

std::uint16_t statusBits(PdsState state) {
  constexpr std::uint16_t kBits[] = {0x0000, 0x0040, 0x0021, 0x0023,
                                     0x0027, 0x0007, 0x000F, 0x0008};
  return kBits[static_cast<std::uint8_t>(state)];
}

PdsCommand decodeCommand(std::uint16_t controlword, std::uint16_t previous) {
  if ((controlword & 0x0080) != 0) {
    return (previous & 0x0080) == 0 ? PdsCommand::fault_reset : PdsCommand::none;
  }
  for (const CommandCoding& coding : kCommands) {
    if ((controlword & coding.mask) == coding.value) return coding.command;
  }
  return PdsCommand::none;
}

PdsTransition transitionFor(PdsState state, PdsCommand command) {
  for (const Row& row : kTransitions) {
    if (row.from == state && row.command == command) return {row.number, row.to};
  }
  return {};
}

}  // namespace cia402::sim
