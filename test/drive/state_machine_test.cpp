// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/state_machine.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>

namespace cia402::drive {
namespace {

struct Row {
  std::uint16_t statusword;
  State state;
};

// Damiao manual sheet 3.2, statuswords after each transition 0..16.
TEST(StateMachine, DecodesTheStatuswordsOfTheDamiaoManual) {
  const Row rows[] = {
      {0x0000, State::not_ready_to_switch_on}, {0x0250, State::switch_on_disabled},
      {0x0231, State::ready_to_switch_on},     {0x0233, State::switched_on},
      {0x0237, State::operation_enabled},      {0x0217, State::quick_stop_active},
      {0x021F, State::fault_reaction_active},  {0x0218, State::fault},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(decodeState(row.statusword), row.state) << std::hex << row.statusword;
  }
}

TEST(StateMachine, IgnoresWarningRemoteAndModeBitsWhenDecoding) {
  const Row rows[] = {
      {0x0000, State::not_ready_to_switch_on}, {0x0040, State::switch_on_disabled},
      {0x0021, State::ready_to_switch_on},     {0x0023, State::switched_on},
      {0x0027, State::operation_enabled},      {0x0007, State::quick_stop_active},
      {0x000F, State::fault_reaction_active},  {0x0008, State::fault},
  };
  // Bits 4, 7..15 carry no state (CiA 402-2, "x" in the coding table).
  const std::uint16_t free_bits = 0xFF90;
  for (const Row& row : rows) {
    for (unsigned bit = 0; bit < 16; ++bit) {
      const auto mask = static_cast<std::uint16_t>(1u << bit);
      if ((free_bits & mask) == 0) continue;
      const auto word = static_cast<std::uint16_t>(row.statusword | mask);
      EXPECT_EQ(decodeState(word), row.state) << std::hex << word;
    }
    const auto all = static_cast<std::uint16_t>(row.statusword | free_bits);
    EXPECT_EQ(decodeState(all), row.state) << std::hex << all;
  }
}

TEST(StateMachine, IgnoresTheQuickStopBitOnlyWhereTheStandardDoes) {
  EXPECT_EQ(decodeState(0x0020), State::not_ready_to_switch_on);
  EXPECT_EQ(decodeState(0x0060), State::switch_on_disabled);
  EXPECT_EQ(decodeState(0x002F), State::fault_reaction_active);
  EXPECT_EQ(decodeState(0x0028), State::fault);
  EXPECT_EQ(decodeState(0x0001), State::unknown);  // ready bits with quick stop bit 0
  EXPECT_EQ(decodeState(0x0003), State::unknown);
}

// 0x0248: Technosoft iPOS8020 (OpenEtherCATsociety/SOEM#461); the standard has bit 6 at 0. Bit 3 is
// "fault" by CiA 402-2, table of the statusword; with bits 0 to 2 all set the drive still reacts.
TEST(StateMachine, AFaultWithBitsOfNoStateIsAFault) {
  for (int bits : {0x0248, 0x0048, 0x0068, 0x0009, 0x000A, 0x000B, 0x000C, 0x000D, 0x000E, 0x0029,
                   0x0249, 0x006E}) {
    const auto word = static_cast<std::uint16_t>(bits);
    EXPECT_EQ(decodeState(word), State::fault) << std::hex << word;
  }
  for (int bits : {0x004F, 0x006F, 0x024F, 0xFFFF}) {
    const auto word = static_cast<std::uint16_t>(bits);
    EXPECT_EQ(decodeState(word), State::fault_reaction_active) << std::hex << word;
  }
}

TEST(StateMachine, BitsThatMatchNoStateAreUnknown) {
  for (int bits : {0x0002, 0x0004, 0x0005, 0x0006, 0x0022, 0x0061, 0x0067, 0xFFF7}) {
    const auto word = static_cast<std::uint16_t>(bits);
    EXPECT_EQ(decodeState(word), State::unknown) << std::hex << word;
  }
}

// Bits of "switched on" and "operation enabled" beside the fault: whether there is power nobody
// knows.
TEST(StateMachine, APowerStageIsOffInAFaultOnlyWhereTheStandardSaysSo) {
  for (int bits : {0x0008, 0x0218, 0x0248, 0xFFF8 & ~0x0040}) {
    EXPECT_TRUE(powerStageOff(State::fault, static_cast<std::uint16_t>(bits))) << bits;
  }
  for (int bits : {0x0009, 0x000A, 0x000C, 0x000E, 0x0249}) {
    EXPECT_FALSE(powerStageOff(State::fault, static_cast<std::uint16_t>(bits))) << bits;
  }
}

struct Step {
  State state;
  Goal goal;
  std::uint16_t controlword;
  int transition;
};

// CiA 402-2: shutdown xxxx 0xxx x110, switch on 0111, enable operation 1111, disable voltage xx0x,
// quick stop x01x, disable operation 0111.
TEST(StateMachine, CommandsEveryStateTowardsEveryGoal) {
  using In = State;
  using G = Goal;
  const Step steps[] = {
      {In::not_ready_to_switch_on, G::disabled, 0x0000, -1},
      {In::not_ready_to_switch_on, G::ready, 0x0000, -1},
      {In::not_ready_to_switch_on, G::switched_on, 0x0000, -1},
      {In::not_ready_to_switch_on, G::enabled, 0x0000, -1},
      {In::not_ready_to_switch_on, G::quick_stop, 0x0000, -1},
      {In::switch_on_disabled, G::disabled, 0x0000, -1},
      {In::switch_on_disabled, G::ready, 0x0006, 2},
      {In::switch_on_disabled, G::switched_on, 0x0006, 2},
      {In::switch_on_disabled, G::enabled, 0x0006, 2},
      {In::switch_on_disabled, G::quick_stop, 0x0000, -1},
      {In::ready_to_switch_on, G::disabled, 0x0000, 7},
      {In::ready_to_switch_on, G::ready, 0x0006, -1},
      {In::ready_to_switch_on, G::switched_on, 0x0007, 3},
      {In::ready_to_switch_on, G::enabled, 0x0007, 3},
      {In::ready_to_switch_on, G::quick_stop, 0x0002, 7},
      {In::switched_on, G::disabled, 0x0000, 10},
      {In::switched_on, G::ready, 0x0006, 6},
      {In::switched_on, G::switched_on, 0x0007, -1},
      {In::switched_on, G::enabled, 0x000F, 4},
      {In::switched_on, G::quick_stop, 0x0002, 10},
      {In::operation_enabled, G::disabled, 0x0007, 5},
      {In::operation_enabled, G::ready, 0x0006, 8},
      {In::operation_enabled, G::switched_on, 0x0007, 5},
      {In::operation_enabled, G::enabled, 0x000F, -1},
      {In::operation_enabled, G::quick_stop, 0x0002, 11},
      {In::quick_stop_active, G::disabled, 0x0000, 12},
      {In::quick_stop_active, G::ready, 0x0000, 12},
      {In::quick_stop_active, G::switched_on, 0x0000, 12},
      {In::quick_stop_active, G::enabled, 0x000F, 16},
      {In::quick_stop_active, G::quick_stop, 0x0002, -1},
      {In::fault_reaction_active, G::disabled, 0x0000, -1},
      {In::fault_reaction_active, G::ready, 0x0000, -1},
      {In::fault_reaction_active, G::switched_on, 0x0000, -1},
      {In::fault_reaction_active, G::enabled, 0x0000, -1},
      {In::fault_reaction_active, G::quick_stop, 0x0000, -1},
      {In::fault, G::disabled, 0x0000, -1},
      {In::fault, G::ready, 0x0000, -1},
      {In::fault, G::switched_on, 0x0000, -1},
      {In::fault, G::enabled, 0x0000, -1},
      {In::fault, G::quick_stop, 0x0000, -1},
      {In::unknown, G::disabled, 0x0002, -1},
      {In::unknown, G::ready, 0x0002, -1},
      {In::unknown, G::switched_on, 0x0002, -1},
      {In::unknown, G::enabled, 0x0000, -1},
      {In::unknown, G::quick_stop, 0x0002, -1},
  };
  for (const Step& step : steps) {
    const Command command = nextCommand(step.state, step.goal);
    const std::string where = std::string(toString(step.state)) + " -> goal " +
                              std::to_string(static_cast<int>(step.goal));
    EXPECT_EQ(command.controlword, step.controlword) << where;
    EXPECT_EQ(command.transition, step.transition) << where;
    if (step.transition >= 0) {
      EXPECT_NE(std::string(command.text).find("transition " + std::to_string(step.transition)),
                std::string::npos)
          << where << ": " << command.text;
    }
  }
}

// CiA 402-2, figure of the power drive system's states: high-level power may be switched off up to
// "ready to switch on" and in "fault".
TEST(StateMachine, KnowsWhereThePowerStageIsOff) {
  const std::pair<std::uint16_t, bool> rows[] = {
      {0x0000, true},   // not ready to switch on
      {0x0040, true},   // switch on disabled
      {0x0021, true},   // ready to switch on
      {0x0023, false},  // switched on
      {0x0027, false},  // operation enabled
      {0x0007, false},  // quick stop active
      {0x000F, false},  // fault reaction active
      {0x0008, true},   // fault
      {0x0001, false},  // no state
  };
  for (const auto& [word, off] : rows) {
    EXPECT_EQ(powerStageOff(decodeState(word), word), off) << std::hex << word;
  }
  EXPECT_FALSE(powerStageOff(State::unknown, 0)) << "no statusword yet";
}

TEST(StateMachine, NoGoalEverSetsFaultResetOrHalt) {
  for (int state = 0; state <= static_cast<int>(State::unknown); ++state) {
    for (int goal = 0; goal <= static_cast<int>(Goal::quick_stop); ++goal) {
      const Command command = nextCommand(static_cast<State>(state), static_cast<Goal>(goal));
      EXPECT_EQ(command.controlword & ~0x000F, 0);
    }
  }
}

TEST(StateMachine, IsLeftByTheTransitionsThatAreAskedFor) {
  struct Way {
    Disabling by;
    std::vector<int> transitions;
    int operation, switched_on;
    std::uint16_t word, next;
  };
  for (const Way& row :
       {Way{{5, 10}, {5, 10}, 5, 10, 0x0007, 0x0000}, Way{{5, 6}, {5, 6, 7}, 5, 6, 0x0007, 0x0006},
        Way{{8, 10}, {8, 7}, 8, 10, 0x0006, 0x0000}, Way{{9, 10}, {9}, 9, 10, 0x0000, 0x0000}}) {
    EXPECT_EQ(row.by.transitions(), row.transitions);
    const Command out = nextCommand(State::operation_enabled, Goal::disabled, row.by);
    EXPECT_EQ(out.transition, row.operation);
    EXPECT_EQ(out.controlword, row.word);
    const Command on = nextCommand(State::switched_on, Goal::disabled, row.by);
    EXPECT_EQ(on.transition, row.switched_on);
    EXPECT_EQ(on.controlword, row.next);
    EXPECT_EQ(nextCommand(State::ready_to_switch_on, Goal::disabled, row.by).transition, 7);
    EXPECT_EQ(nextCommand(State::operation_enabled, Goal::quick_stop, row.by).transition, 11);
    EXPECT_EQ(nextCommand(State::switched_on, Goal::enabled, row.by).transition, 4);
  }
}

TEST(StateMachine, NamesStates) {
  EXPECT_STREQ(toString(State::not_ready_to_switch_on), "not ready to switch on");
  EXPECT_STREQ(toString(State::switch_on_disabled), "switch on disabled");
  EXPECT_STREQ(toString(State::ready_to_switch_on), "ready to switch on");
  EXPECT_STREQ(toString(State::switched_on), "switched on");
  EXPECT_STREQ(toString(State::operation_enabled), "operation enabled");
  EXPECT_STREQ(toString(State::quick_stop_active), "quick stop active");
  EXPECT_STREQ(toString(State::fault_reaction_active), "fault reaction active");
  EXPECT_STREQ(toString(State::fault), "fault");
  EXPECT_STREQ(toString(State::unknown), "unknown");
}

TEST(StateMachine, WhatIsNoStateIsUnknown) {
  for (const int value : {9, 10, 255}) EXPECT_STREQ(toString(static_cast<State>(value)), "unknown");
}

}  // namespace
}  // namespace cia402::drive
