// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/definition/terminals.h"
#include "sim/dictionary/object_dictionary.h"
#include "sim/drive/homing_switches.h"

namespace cia402::sim {

class DriveCore;

/// The digital inputs of one axis: which switch is at which terminal, and what the virtual ones do
/// that come over the bus. Without terminals in the definition it does nothing.
class Terminals {
 public:
  /// Both must outlive it.
  Terminals(const TerminalsDefinition& definition, ObjectDictionary& dictionary)
      : definition_(definition), dictionary_(dictionary) {}

  /// One of its objects, which it wants to hear of.
  bool holds(fieldbus::ObjectId id) const;
  /// Power-on: levels are as they are, without edges.
  void start(DriveCore& core);
  struct Change {
    std::vector<InputFunction> edges;      ///< what has been triggered
    bool doubled = false;                  ///< a function has two inputs, and had not
    bool mended = false;                   ///< none has two any more
    bool enabled = false, paused = false;  ///< what those of a maker's modes say
  };
  /// Its objects were written, or its inputs have changed. @param inputs their electrical levels
  Change look(AxisSwitches& switches, std::uint32_t inputs);
  /// An input with this function is active.
  bool active(InputFunction function) const;

 private:
  std::uint64_t number(fieldbus::ObjectId id) const;
  std::optional<unsigned> bitOf(std::size_t input) const;
  InputFunction functionOf(const TerminalsDefinition::Input& input) const;
  bool isInput(const TerminalsDefinition::Input& input) const;
  bool twice() const;
  void addEdges(std::uint32_t inputs, Change& change) const;
  void connect(AxisSwitches& switches) const;
  std::uint64_t levels() const;

  const TerminalsDefinition& definition_;
  ObjectDictionary& dictionary_;
  std::uint64_t levels_ = 0;  ///< of the virtual inputs
  std::uint32_t inputs_ = 0;  ///< of those with a terminal
  bool doubled_ = false;
};

struct FaultDefinition;
/// Looks what has changed at the inputs, and does what it means to the axis.
/// @param doubled what the drive reports where a function has two inputs; nullptr: nothing
void obey(Terminals& terminals, DriveCore& core, ObjectDictionary& dictionary,
          const FaultDefinition* doubled);

}  // namespace cia402::sim
