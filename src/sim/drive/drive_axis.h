// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/drive/absolute_encoder.h"
#include "sim/drive/core.h"
#include "sim/drive/terminals.h"

namespace cia402::sim {

/// One axis of the device.
struct DriveAxis {
  DriveAxis(const DriveDefinition& definition, unsigned number, const AxisMechanics& axis_mechanics,
            ObjectDictionary& dictionary, DriveCore::Reports& reports)
      : mechanics(axis_mechanics),
        core(definition, number, mechanics, dictionary, reports),
        terminals(definition.terminals, dictionary),
        encoder(definition, dictionary, core) {
    const auto reversed = definition.objects.find(Role::reversed);
    if (reversed != definition.objects.end()) direction = dictionary.find(reversed->second);
  }

  /// Power or reset, before the core starts.
  void start() {
    terminals.start(core);
    if (direction != nullptr) turnForward(direction->acting() != 0);
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

  AxisMechanics mechanics;
  DriveCore core;
  Terminals terminals;
  AbsoluteEncoder encoder;
  const Entry* direction = nullptr;  ///< which way round it counts; none: always the same
  unsigned bad_floats = 0;
};

}  // namespace cia402::sim
