// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "campaign/oracle.h"

namespace cia402::campaign {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::vector<std::unique_ptr<Oracle>> allOracles(const Stage& stage) {
  std::vector<std::unique_ptr<Oracle>> oracles;
  oracles.push_back(makeCommandedMotion(stage));
  oracles.push_back(makeSlowStops(stage));
  oracles.push_back(makePowerOracle(stage));
  oracles.push_back(makeTargetSteps(stage));
  oracles.push_back(makeMotorLimits(stage));
  oracles.push_back(makeEffortLimits(stage));
  oracles.push_back(makeSnapshots(stage));
  oracles.push_back(makeFloats(stage));
  oracles.push_back(makeAnswers(stage));
  oracles.push_back(makeVainRequests(stage));
  oracles.push_back(makeTakenDrives(stage));
  return oracles;
}

}  // namespace cia402::campaign
