// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// However and whenever trajectories are stopped: no motor turns faster than before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>

#include "bus/group_scene.h"

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using test::kPeriod;
using test::Outcomes;
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

/// A procedure that stops takes the joints from their trajectory.
struct CalledStop : test::GroupScene {
  explicit CalledStop(const config::RobotConfig& config = test::testRobot()) : GroupScene(config) {}
  /// Its ramp from 0.375 rad/s takes 0.6 s.
  static config::RobotConfig slow() {
    config::RobotConfig config = test::testRobot();
    for (drive::AxisConfig& axis : config.axes) axis.limits.acceleration = 0.6;
    return config;
  }
  Outcomes start(double goal = 1.0, double seconds = 1.0) {
    const Outcomes ended = send(world.trajectory("arm", {{{goal, -0.5 * goal}, seconds}}));
    world.run(fromSeconds(seconds / 2.0));
    return ended;
  }
  /// It was told to stop: that is told once, when both motors stand.
  void expectStopped(const Outcomes& ended, const std::string& message) {
    EXPECT_TRUE(ended->empty()) << "they move";
    ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 3s));
    EXPECT_EQ(ended->front().end, TrajectoryEnd::stopped);
    EXPECT_EQ(ended->front().code, motion::TrajectoryErrorCode::successful);
    EXPECT_EQ(ended->front().message, message);
    const int shoulder = position(0), elbow = position(1);
    world.run(1s);
    EXPECT_EQ(position(0), shoulder);
    EXPECT_EQ(position(1), elbow);
    EXPECT_EQ(ended->size(), 1u);
    EXPECT_EQ(world.eventsWith("arm: "), 1u) << world.allEvents();
  }
};

TEST_F(CalledStop, IsToldAsSuchOnceTheMotorsStand) {
  for (const ProcedureKind kind :
       {ProcedureKind::halt, ProcedureKind::quick_stop, ProcedureKind::disable}) {
    ASSERT_TRUE(world.call(ProcedureKind::enable).success);
    const double way = position(0) < 50000 ? 1.0 : 0.0;
    const Outcomes ended = start(way);
    world.events.clear();
    (void)world.begin(kind);
    expectStopped(ended, std::string("arm: stopped: shoulder: ") + toString(kind) + " was called");
  }
}

TEST_F(CalledStop, OfOneJointStopsTheOthers) {
  const Outcomes ended = start();
  world.events.clear();
  (void)world.begin(ProcedureKind::halt, "elbow");
  expectStopped(ended, "arm: stopped: elbow: halt was called");
  EXPECT_LT(position(0), 70000) << "its ramp from the middle of the way";
}

TEST_F(CalledStop, EndsWhatWaitsBehindWhatItStops) {
  const Outcomes runs = start();
  TrajectoryCommand next = world.trajectory("arm", {{{0.0, 0.0}, 1.0}});
  next.start_time = world.now + 300ms;
  const Outcomes waits = send(std::move(next));
  (void)world.begin(ProcedureKind::halt);
  world.run(2s);
  ASSERT_EQ(runs->size(), 1u);
  EXPECT_EQ(runs->front().end, TrajectoryEnd::stopped);
  ASSERT_EQ(waits->size(), 1u);
  EXPECT_EQ(waits->front().end, TrajectoryEnd::stopped);
}

/// The others go on where one that stops does not stop the group.
struct LonelyCalledStop : CalledStop {
  LonelyCalledStop() : CalledStop(robot()) {}
  static config::RobotConfig robot() {
    config::RobotConfig config = test::testRobot();
    config.groups[0].stop_group_on_fault = false;
    return config;
  }
};

TEST_F(LonelyCalledStop, OfOneJointIsToldAtTheGoalOfTheOthers) {
  const Outcomes ended = start();
  world.events.clear();
  (void)world.begin(ProcedureKind::halt, "elbow");
  expectStopped(ended, "arm: stopped: elbow: halt was called");
  EXPECT_EQ(position(0), 100000);
}

TEST_F(LonelyCalledStop, IsToldAlsoOfAJointThatWasEnabledAgainMeanwhile) {
  const Outcomes ended = start();
  world.events.clear();
  ASSERT_TRUE(world.call(ProcedureKind::disable, "elbow").success);
  ASSERT_TRUE(world.call(ProcedureKind::enable, "elbow").success);
  expectStopped(ended, "arm: stopped: elbow: disable was called");
}

struct SlowCalledStop : CalledStop {
  SlowCalledStop() : CalledStop(slow()) {}
};

TEST_F(SlowCalledStop, IsWaitedForAsLongAsItTakes) {
  const Outcomes ended = start(2.0, 8.0);
  world.events.clear();
  (void)world.begin(ProcedureKind::halt);
  const Time called = world.now;
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 3s));
  EXPECT_GT(world.now - called, 600ms) << "0.375 rad/s by 0.6 rad/s^2";
  EXPECT_EQ(ended->front().message, "arm: stopped: shoulder: halt was called");
}

}  // namespace
}  // namespace cia402::bus
