// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "sim/drive/absolute_encoder.h"
#include "sim/drive/core.h"
#include "sim/drive/monitors.h"
#include "sim/drive/terminals.h"

namespace cia402::sim {

/// One axis of the device.
struct DriveAxis {
  DriveAxis(const DriveDefinition& definition, unsigned number, const AxisMechanics& axis_mechanics,
            ObjectDictionary& dictionary, DriveCore::Reports& reports)
      : objects(dictionary),
        doubled(definition.fault("terminal_setup")),
        mechanics(axis_mechanics),
        core(definition, number, mechanics, dictionary, reports),
        terminals(definition.terminals, dictionary),
        encoder(definition, dictionary, core),
        monitors(number == 0 ? definition.own.monitors : kNoMonitors, dictionary, core) {
    const auto reversed = definition.objects.find(Role::reversed);
    if (reversed != definition.objects.end()) direction = dictionary.find(reversed->second);
  }

  /// Power or reset, before the core starts. @param power_on it had none
  void start(bool power_on, Time now) {
    terminals.start(core);
    monitors.start(power_on, now);
    if (direction != nullptr) turnForward(direction->acting() != 0);
  }
  /// Looks what has changed at its inputs.
  void obey() {
    sim::obey(terminals, core, objects, doubled);
    core.motion().publish();
  }
  /// All but the state of the device.
  DriveTruth truth() {
    const DriveMotion& motion = core.motion();
    DriveTruth truth;
    truth.position_turns = motion.motor().truePosition();
    truth.velocity_turns = motion.motor().trueVelocity();
    truth.power_stage_on = motion.powered();
    truth.moving = std::fabs(truth.velocity_turns) > 1e-3;
    truth.statusword = core.statusword();
    truth.mode = static_cast<int>(core.mode());
    truth.outputs = core.outputs();
    truth.bad_floats_received = bad_floats;
    return truth;
  }
  /// What comes by itself. Often.
  void look(Time now) {
    encoder.look();
    monitors.look(now);
  }
  /// Which way round the drive counts from now on; where it is 0 stays.
  void turnForward(bool reversed) {
    DriveMotion& motion = core.motion();
    if (motion.motor().mirrored() == reversed) return;
    const double counter = motion.counter();
    motion.motor().mirror(reversed);
    motion.switches().mirror(reversed);
    motion.setCounter(-counter);
  }

  ObjectDictionary& objects;
  const FaultDefinition* doubled;  ///< where a function has two inputs; nullptr: nothing
  AxisMechanics mechanics;
  DriveCore core;
  Terminals terminals;
  AbsoluteEncoder encoder;
  inline static const MonitorsDefinition kNoMonitors;
  Monitors monitors;                 ///< of the device, with its first axis
  const Entry* direction = nullptr;  ///< which way round it counts; none: always the same
  unsigned bad_floats = 0;
};

}  // namespace cia402::sim
