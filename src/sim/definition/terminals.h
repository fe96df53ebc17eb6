// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "fieldbus/object.h"

namespace cia402::sim {

/// What a digital input of a drive can be for.
enum class InputFunction : std::uint8_t {
  none,
  negative_limit,
  positive_limit,
  home_switch,
  fault_reset,     ///< an edge resets faults
  set_home,        ///< an edge makes the present position 0
  clear_history,   ///< an edge empties 1003h
  emergency_stop,  ///< an edge stops as the role emergency_stop does
  motor_enable,    ///< enables the motor in a maker's mode (MakerModes)
  pause,           ///< halts it there
  step,            ///< an edge brings a step there
};

/// What an axis can tell by a digital output.
enum class OutputFunction : std::uint8_t {
  alarm,    ///< a fault or a warning
  reached,  ///< bit 10 of the statusword
  holding,  ///< the motor has power
  turning,
};

/// Digital inputs whose functions the drive is told by objects. Logic of an input with a terminal:
/// 0 active low, 1 high, 2 to 4 by edges; of a virtual one, whose level comes over the bus: 0
/// active high, 1 by rising edges.
struct TerminalsDefinition {
  struct Input {
    fieldbus::ObjectId function, logic;
    std::optional<fieldbus::ObjectId> is_output;  ///< not 0: the terminal is no input
  };
  std::vector<Input> with_terminal, without;  ///< the second ones are virtual
  /// Instead of their logic: an object whose bit n turns input n, active where nothing conducts.
  std::optional<fieldbus::ObjectId> inversion;
  /// With it: a bit for each input whose contact conducts while its switch is not active.
  std::uint32_t normally_closed = 0;
  unsigned first_bit = 0;  ///< with it: of the inputs in the role digital_inputs
  /// Or: the bit of each input in the role digital_inputs, which is 1 where its function is active.
  /// Its switch is wired for logic 0; a logic of 1 turns it round. Inputs beyond these are not
  /// shown.
  std::vector<unsigned> bits;
  std::optional<fieldbus::ObjectId> levels;   ///< of the virtual ones, a bit each
  std::optional<fieldbus::ObjectId> enabled;  ///< the virtual ones act
  std::optional<fieldbus::ObjectId> seen;     ///< those of them that are active
  std::map<std::int64_t, InputFunction> functions;

  bool empty() const { return with_terminal.empty() && without.empty(); }
};

}  // namespace cia402::sim
