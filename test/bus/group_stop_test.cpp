// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// However and whenever trajectories are stopped: no motor turns faster than before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "bus/group_scene.h"

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;
using test::kPeriod;
using test::RobotWorld;

constexpr double kFarthest = 2.9;  // the limit is 3 rad

struct AnyStop : test::GroupScene {
  explicit AnyStop(const config::RobotConfig& config = test::testRobot())
      : GroupScene(config), partial(config.groups[0].allow_partial_joints_goal) {}
  static config::RobotConfig gentle() {
    config::RobotConfig config = test::testRobot();
    config.groups[0].stop_trajectory_duration = 0.6;
    config.groups[0].allow_partial_joints_goal = true;
    return config;
  }

  double between(double least, double most) {
    return least + (most - least) * static_cast<double>(random()) / 4294967296.0;
  }
  bool chance(double share) { return between(0.0, 1.0) < share; }

  /// Three points that ask for at most three quarters of the velocity limit on the average.
  TrajectoryCommand anyTrajectory() {
    std::vector<RobotWorld::Point> points;
    double places[] = {world.drives[0].radians(), world.drives[1].radians()}, time = 0.0;
    for (int i = 0; i < 3; ++i) {
      double farthest = 0.0;
      RobotWorld::Point point;
      for (double& place : places) {
        const double next = between(-kFarthest, kFarthest);
        farthest = std::max(farthest, std::abs(next - place));
        point.positions.push_back(place = next);
      }
      point.seconds = time += 0.7 + farthest / between(0.3, 1.0);
      points.push_back(point);
    }
    TrajectoryCommand command = world.trajectory("arm", points);
    command.id = ++last_id;
    if (chance(0.3)) command.start_time = world.now + fromSeconds(between(-0.2, 0.3));
    return command;
  }

  /// @return the joints that it stops.
  std::vector<bool> anyStop() {
    if (chance(0.3)) {
      world.call(CancelCommand{"arm", last_id});
      return {true, true};
    }
    TrajectoryCommand nothing = world.trajectory("arm", {});
    const bool elbow_alone = partial && chance(0.5);
    if (elbow_alone) nothing.joints = {"elbow"};
    send(std::move(nothing));
    return {!elbow_alone, true};
  }

  void play(int stops) {
    for (int i = 0; i < stops; ++i) {
      send(anyTrajectory());
      moved += answer.success ? 1 : 0;
      world.run(fromSeconds(between(0.0, 4.0)));
      std::size_t begin[] = {world.drives[0].targets.size(), world.drives[1].targets.size()};
      const std::vector<bool> stopped = anyStop();
      world.run(fromSeconds(between(0.0, 0.3)));
      if (chance(0.3)) anyStop();
      world.run(1200ms);
      for (std::size_t drive = 0; drive < 2; ++drive) {
        if (stopped[drive]) expectNeverFaster(drive, begin[drive]);
      }
      if (HasFatalFailure()) return;
      send(world.trajectory("arm", {}));
      world.run(1200ms);
    }
  }

  void expectNeverFaster(std::size_t drive, std::size_t begin) {
    const auto& targets = world.drives[drive].targets;
    ASSERT_GT(targets.size(), begin + 10);
    int slowest = std::abs(targets[begin - 1] - targets[begin - 2]);
    stopped_in_motion += slowest > 20 ? 1 : 0;
    for (std::size_t i = begin; i < targets.size(); ++i) {
      const int speed = std::abs(targets[i] - targets[i - 1]);
      // Counts are rounded: one more in one cycle, one less in another.
      ASSERT_LE(speed, slowest + 1) << "cycle " << i << ", stopped in " << begin;
      slowest = std::min(slowest, speed);
    }
    ASSERT_EQ(targets.back(), targets[targets.size() - 2]) << "at rest in the end";
  }

  const bool partial;
  std::mt19937 random{1};
  std::uint64_t last_id = 0;
  int moved = 0, stopped_in_motion = 0;
};

TEST_F(AnyStop, NeverMakesAJointFaster) {
  play(150);
  EXPECT_GT(moved, 75);
  EXPECT_GT(stopped_in_motion, 75);
}

struct AnyGentleStop : AnyStop {
  AnyGentleStop() : AnyStop(gentle()) {}
};

TEST_F(AnyGentleStop, NeverMakesAJointFasterEither) {
  play(150);
  EXPECT_GT(moved, 75);
  EXPECT_GT(stopped_in_motion, 50);
}

}  // namespace
}  // namespace cia402::bus
