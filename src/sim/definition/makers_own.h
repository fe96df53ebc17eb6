// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/definition/effect.h"
#include "sim/definition/maker_states.h"
#include "sim/definition/monitors.h"
#include "sim/definition/own_bus.h"

namespace cia402::sim {

/// What objects of the maker's own do beside CiA 402.
struct MakersOwnDefinition {
  OwnBusDefinition bus;
  Effects effects;
  std::vector<fieldbus::ObjectId> clamped;  ///< out of range they take the limit
  MakerStates states;
  MonitorsDefinition monitors;
  double full_pulse_width = 10.0;  ///< turns/s of MakerModes; no manual tells it
};

}  // namespace cia402::sim
