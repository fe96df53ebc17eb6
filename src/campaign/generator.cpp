// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/generator.h"

#include "campaign/history.h"

namespace cia402::campaign {

Scene makeScene(std::uint64_t seed, double seconds) {
  Random random(seed * 0x9E3779B97F4A7C15U + 1);
  const RobotPlan robot = planRobot(random);
  Scene scene;
  scene.seed = seed;
  scene.robot = robot.yaml;
  scene.actions = planHistory(random, robot, seconds);
  return scene;
}

}  // namespace cia402::campaign
