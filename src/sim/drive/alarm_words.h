// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "sim/definition/drive_definition.h"

namespace cia402::sim {

/// What the drive's own objects say of its alarms (FaultDefinition::word), as NiMotion has it in
/// 200Eh. Reactions: 0 to 2 fault, stopped as 605Eh says, or where that is negative by coasting,
/// slow ramp, quick ramp; 3 warning, the motor is halted until it is over; 4 warning; 5 it is
/// remembered only; 6 nothing. Likewise what says by which ramp a fault stops the motor
/// (FaultDefinition::reaction_by).
class AlarmWords {
 public:
  /// Both must outlive it.
  AlarmWords(const DriveDefinition& definition, ObjectDictionary& dictionary)
      : definition_(definition), dictionary_(dictionary) {}

  /// The alarm as it is set now; the same place for the same alarm.
  const FaultDefinition& asSet(const FaultDefinition& fault);

 private:
  const FaultDefinition& reacting(const FaultDefinition& fault);

  const DriveDefinition& definition_;
  ObjectDictionary& dictionary_;
  std::map<std::string, FaultDefinition> set_;  ///< by name
};

}  // namespace cia402::sim
