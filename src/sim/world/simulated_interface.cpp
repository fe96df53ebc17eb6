// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/simulated_interface.h"

namespace cia402::sim {

SimulatedInterface::SimulatedInterface(const std::vector<SimulatedAxis>& axes, double bitrate,
                                       Time now)
    : world_(bitrate), interface_(world_.bus(), "master") {
  world_.advance(now);
  for (const SimulatedAxis& axis : axes) {
    world_.addDrive(axis.name, axis.definition, axis.node, axis.mechanics, axis.identity);
  }
  interface_.setAdvance([this](Time time) { world_.advance(time); });
  world_.powerOn();
}

std::string SimulatedInterface::describe() const {
  return "simulated bus with " + std::to_string(world_.driveCount()) + " drives, " +
         can::toString(interface_.state());
}

}  // namespace cia402::sim
