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
        encoder(definition, dictionary, core) {}

  AxisMechanics mechanics;
  DriveCore core;
  Terminals terminals;
  AbsoluteEncoder encoder;
  unsigned bad_floats = 0;
};

}  // namespace cia402::sim
