// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "bus/robot_world.h"

namespace cia402::bus::test {

/// How a trajectory ended, once it has; each is told once.
using Outcomes = std::shared_ptr<std::vector<TrajectoryOutcome>>;

/// An enabled robot with trajectories for its group arm (shoulder, elbow), and what becomes of
/// them.
struct GroupScene : testing::Test {
  explicit GroupScene(const config::RobotConfig& config = testRobot()) : world(config) {
    world.enable();
  }
  Outcomes send(TrajectoryCommand command) {
    auto outcomes = std::make_shared<std::vector<TrajectoryOutcome>>();
    command.ended = [outcomes](const TrajectoryOutcome& outcome) { outcomes->push_back(outcome); };
    answer = world.call(std::move(command));
    return outcomes;
  }
  /// Velocity limit 2 rad/s, acceleration limit 10 rad/s² in counts a cycle, rounded.
  void expectSmooth(std::size_t drive) const {
    const auto& targets = world.drives[drive].targets;
    for (std::size_t i = 2; i < targets.size(); ++i) {
      ASSERT_LE(std::abs(targets[i] - targets[i - 1]), 800 + 1) << "cycle " << i;
      ASSERT_LE(std::abs(targets[i] - 2 * targets[i - 1] + targets[i - 2]), 16 + 3)
          << "cycle " << i;
    }
  }
  int position(std::size_t drive) const { return world.drives[drive].position; }

  RobotWorld world;
  TrajectoryAnswer answer;  ///< to what was sent last
};

}  // namespace cia402::bus::test
