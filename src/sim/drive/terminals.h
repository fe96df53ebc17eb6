// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/definition/terminals.h"
#include "sim/dictionary/object_dictionary.h"
#include "sim/drive/homing_switches.h"

namespace cia402::sim {

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
  void start(AxisSwitches& switches);
  struct Change {
    std::vector<InputFunction> edges;  ///< what has been triggered
    bool doubled = false;              ///< a function has two inputs, and had not
    bool mended = false;               ///< none has two any more
  };
  /// Its objects were written.
  Change look(AxisSwitches& switches);

 private:
  std::uint64_t number(fieldbus::ObjectId id) const;
  InputFunction functionOf(const TerminalsDefinition::Input& input) const;
  bool twice() const;
  void connect(AxisSwitches& switches) const;
  std::uint64_t levels() const;

  const TerminalsDefinition& definition_;
  ObjectDictionary& dictionary_;
  std::uint64_t levels_ = 0;
  bool doubled_ = false;
};

class DriveCore;
struct FaultDefinition;
/// Does what a change of the inputs means to the axis.
/// @param doubled what the drive reports where a function has two inputs; nullptr: nothing
void obey(const Terminals::Change& change, DriveCore& core, ObjectDictionary& dictionary,
          const FaultDefinition* doubled);

}  // namespace cia402::sim
