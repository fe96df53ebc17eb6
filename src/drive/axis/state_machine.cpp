// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/state_machine.h"

#include <array>
#include <cstddef>

namespace cia402::drive {
namespace {

constexpr std::size_t kStates = 9;
constexpr std::size_t kGoals = 5;

/// CiA 402-2, table "state coding": `x` bits are masked out.
struct StateCode {
  std::uint16_t mask, value;
  State state;
};
constexpr StateCode kStateCodes[] = {
    {0x004F, 0x0000, State::not_ready_to_switch_on},  // xxxx xxxx x0xx 0000
    {0x004F, 0x0040, State::switch_on_disabled},      // xxxx xxxx x1xx 0000
    {0x006F, 0x0021, State::ready_to_switch_on},      // xxxx xxxx x01x 0001
    {0x006F, 0x0023, State::switched_on},             // xxxx xxxx x01x 0011
    {0x006F, 0x0027, State::operation_enabled},       // xxxx xxxx x01x 0111
    {0x006F, 0x0007, State::quick_stop_active},       // xxxx xxxx x00x 0111
    {0x004F, 0x000F, State::fault_reaction_active},   // xxxx xxxx x0xx 1111
    {0x004F, 0x0008, State::fault},                   // xxxx xxxx x0xx 1000
    // Bit 3 with bits of no state, such as 0x0248 (Technosoft iPOS8020): a fault reset is what
    // helps.
    {0x000F, 0x000F, State::fault_reaction_active},  // xxxx xxxx xxxx 1111
    {0x0008, 0x0008, State::fault},                  // xxxx xxxx xxxx 1xxx
};

constexpr const char* kStateNames[kStates] = {"not ready to switch on",
                                              "switch on disabled",
                                              "ready to switch on",
                                              "switched on",
                                              "operation enabled",
                                              "quick stop active",
                                              "fault reaction active",
                                              "fault",
                                              "unknown"};

// The commands of CiA 402-2, table "command coding", with the transition each causes.
constexpr Command kNothing{0x0000, -1, "no command"};
constexpr Command kShutdown2{0x0006, 2, "shutdown (transition 2)"};
constexpr Command kSwitchOn3{0x0007, 3, "switch on (transition 3)"};
constexpr Command kEnable4{0x000F, 4, "enable operation (transition 4)"};
constexpr Command kDisableOperation5{0x0007, 5, "disable operation (transition 5)"};
constexpr Command kShutdown6{0x0006, 6, "shutdown (transition 6)"};
constexpr Command kDisableVoltage7{0x0000, 7, "disable voltage (transition 7)"};
constexpr Command kShutdown8{0x0006, 8, "shutdown (transition 8)"};
constexpr Command kDisableVoltage9{0x0000, 9, "disable voltage (transition 9)"};
constexpr Command kDisableVoltage10{0x0000, 10, "disable voltage (transition 10)"};
constexpr Command kQuickStop11{0x0002, 11, "quick stop (transition 11)"};
constexpr Command kDisableVoltage12{0x0000, 12, "disable voltage (transition 12)"};
constexpr Command kEnable16{0x000F, 16, "enable operation (transition 16)"};
constexpr Command kQuickStop7{0x0002, 7, "quick stop (transition 7)"};
constexpr Command kQuickStop10{0x0002, 10, "quick stop (transition 10)"};
constexpr Command kStayReady{0x0006, -1, "shutdown (stay)"};
constexpr Command kStaySwitchedOn{0x0007, -1, "switch on (stay)"};
constexpr Command kStayEnabled{0x000F, -1, "enable operation (stay)"};
constexpr Command kStayQuickStop{0x0002, -1, "quick stop (stay)"};

/// kCommands[state][goal]; the columns are disabled, ready, switched on, enabled, quick stop.
/// Operation is left for "disabled" by transition 5, whose option code (605Ch) ramps down by
/// default, not by transition 9, which lets the axis coast; Disabling may say otherwise.
constexpr std::array<std::array<Command, kGoals>, kStates> kCommands = {{
    // not ready to switch on: the drive initialises itself (transitions 0 and 1)
    {{kNothing, kNothing, kNothing, kNothing, kNothing}},
    // switch on disabled
    {{kNothing, kShutdown2, kShutdown2, kShutdown2, kNothing}},
    // ready to switch on
    {{kDisableVoltage7, kStayReady, kSwitchOn3, kSwitchOn3, kQuickStop7}},
    // switched on
    {{kDisableVoltage10, kShutdown6, kStaySwitchedOn, kEnable4, kQuickStop10}},
    // operation enabled
    {{kDisableOperation5, kShutdown8, kDisableOperation5, kStayEnabled, kQuickStop11}},
    // quick stop active
    {{kDisableVoltage12, kDisableVoltage12, kDisableVoltage12, kEnable16, kStayQuickStop}},
    // fault reaction active: the drive goes on by itself (transition 14)
    {{kNothing, kNothing, kNothing, kNothing, kNothing}},
    // fault: only a fault reset leaves it (transition 15)
    {{kNothing, kNothing, kNothing, kNothing, kNothing}},
    // unknown: nothing that could move anything, nor let an axis coast that moves
    {{kStayQuickStop, kStayQuickStop, kStayQuickStop, kNothing, kStayQuickStop}},
}};

}  // namespace

const char* toString(State state) {
  const auto index = static_cast<std::size_t>(state);
  return kStateNames[index < kStates ? index : kStates - 1];
}

bool powerStageOff(State state, std::uint16_t statusword) {
  constexpr std::uint16_t kInOperation = 0x0007;
  if (state == State::fault) return (statusword & kInOperation) == 0;
  return state == State::switch_on_disabled || state == State::ready_to_switch_on ||
         state == State::not_ready_to_switch_on;
}

State decodeState(std::uint16_t statusword) {
  for (const StateCode& code : kStateCodes) {
    if ((statusword & code.mask) == code.value) return code.state;
  }
  return State::unknown;
}

Command nextCommand(State state, Goal goal, const Disabling& disabling) {
  const auto row = static_cast<std::size_t>(state);
  const auto column = static_cast<std::size_t>(goal);
  if (goal == Goal::disabled && state == State::operation_enabled) {
    if (disabling.from_operation == 8) return kShutdown8;
    if (disabling.from_operation == 9) return kDisableVoltage9;
  }
  if (goal == Goal::disabled && state == State::switched_on && disabling.from_switched_on == 6) {
    return kShutdown6;
  }
  if (row >= kStates || column >= kGoals) return kNothing;
  return kCommands[row][column];
}

}  // namespace cia402::drive
