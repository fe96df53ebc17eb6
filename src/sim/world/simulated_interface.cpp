// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/simulated_interface.h"

namespace cia402::sim {

SimulatedInterface::SimulatedInterface(const std::vector<SimulatedDrive>& drives, double bitrate,
                                       Time now)
    : drives_(drives), world_(bitrate), interface_(world_.bus(), "master") {
  world_.advance(now);
  addTo(world_, drives);
  interface_.setAdvance([this](Time time) { world_.advance(time); });
  world_.powerOn();
}

AxisOfDrive SimulatedInterface::find(const std::string& axis) {
  const std::optional<AxisPlace> place = findAxis(drives_, axis);
  return place ? AxisOfDrive{&world_.drive(place->drive), place->axis} : AxisOfDrive();
}

std::string SimulatedInterface::describe() const {
  return "simulated bus with " + std::to_string(world_.driveCount()) + " drives, " +
         can::toString(interface_.state());
}

}  // namespace cia402::sim
