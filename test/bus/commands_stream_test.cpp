// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Streams of set-points that begin anew, end, or are interrupted.
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using test::FakeDrive;
using test::RobotWorld;
using namespace std::chrono_literals;

config::RobotConfig shoulderIn(const std::string& mode) {
  config::RobotConfig robot = test::testRobot();
  robot.axes.resize(1);
  robot.devices.resize(1);
  robot.axes[0].mode = mode;
  robot.groups[0].joints = {"shoulder"};
  return robot;
}

struct StreamWorld : RobotWorld {
  explicit StreamWorld(const config::RobotConfig& config) : RobotWorld(config) { enable(); }
  explicit StreamWorld(const std::string& mode) : StreamWorld(shoulderIn(mode)) {}

  /// @return the refusal; empty if it was taken.
  std::string command(double value) {
    const auto answers = begin(SetpointCommand{0, value});
    return answers->empty() ? std::string() : answers->front().message;
  }
  FakeDrive& drive() { return drives[0]; }
  const drive::Axis& shoulder() const { return network.axis(0); }
  /// The target positions of the next `count` cycles.
  std::vector<std::int32_t> targets(std::size_t count) {
    drive().targets.clear();
    EXPECT_TRUE(runUntil([&] { return drive().targets.size() == count; }));
    return drive().targets;
  }
  void expectSmooth() {
    const std::vector<std::int32_t>& all = drive().targets;
    for (std::size_t i = 2; i < all.size(); ++i) {  // 2 rad/s, 10 rad/s², 4 ms, each rounded
      ASSERT_LE(std::abs(all[i] - all[i - 1]), 800 + 1) << "cycle " << i;
      ASSERT_LE(std::abs(all[i] - 2 * all[i - 1] + all[i - 2]), 16 + 2) << "cycle " << i;
    }
  }
};

TEST(AxisStream, IsForgottenWhenATrajectoryMovesTheAxis) {
  StreamWorld world("cyclic_position");
  ASSERT_EQ(world.command(0.5), "");
  world.run(1s);
  ASSERT_TRUE(world.move({1.0}, 1.0).success);
  world.run(500ms);
  EXPECT_FALSE(world.shoulder().stream().dried_up);
  world.run(2s);
  EXPECT_EQ(world.drive().position, 100000) << "it does not go back to 0.5 rad";
}

TEST(AxisStream, GoesOnFromTheEndOfATrajectory) {
  StreamWorld world("cyclic_position");
  ASSERT_EQ(world.command(0.5), "");
  world.run(1s);
  ASSERT_TRUE(world.move({1.0}, 1.0).success);
  world.run(1100ms);
  ASSERT_EQ(world.command(1.2), "");
  world.run(1s);
  EXPECT_EQ(world.drive().position, 120000);
  world.expectSmooth();
}

TEST(AxisStream, IsForgottenWhenThePositionGetsAnotherZero) {
  StreamWorld world("cyclic_position");
  ASSERT_EQ(world.command(0.5), "");
  world.run(1s);
  ProcedureCommand declare;
  declare.axis = "shoulder";
  declare.request.kind = ProcedureKind::set_position;
  declare.request.position = 2.0;
  const Answer declared = world.call(declare);
  ASSERT_TRUE(declared.success) << declared.message;
  world.run(1s);
  EXPECT_EQ(world.drive().position, 50000) << "0.5 rad of the old zero is where it stands";
  ASSERT_EQ(world.command(2.3), "");
  world.run(1s);
  EXPECT_EQ(world.drive().position, 80000);
  world.expectSmooth();
}

TEST(AxisStream, AMotorThatStoodInTheWayTakesTheNextSetPoint) {
  StreamWorld world("cyclic_position");
  ASSERT_EQ(world.command(1.0), "");
  world.run(100ms);
  world.drive().blocked = true;
  world.run(1s);  // its set-point was called back
  world.drive().blocked = false;
  world.run(20ms);
  ASSERT_EQ(world.command(0.8), "");
  world.run(200ms);
  world.now += 50ms;  // not the end of this stream
  world.run(2s);
  EXPECT_EQ(world.drive().position, 80000);
}

TEST(AxisStream, BeginsToMoveInTheFirstCycleAfterMissedOnes) {
  StreamWorld world("cyclic_position");
  ASSERT_EQ(world.command(1.0), "");
  world.run(300ms);
  const std::int32_t from = world.drive().target_position;
  world.now += 50ms;
  EXPECT_NEAR(world.targets(1).front(), from + 16, 1);  // 10 rad/s² * (4 ms)²
}

// A stream that ends at speed is brought to rest ahead of its last position.
TEST(AxisStream, ThatEndedAtSpeedDoesNotTurnBackAfterMissedCycles) {
  StreamWorld world("cyclic_position");
  double position = 0.0;
  double velocity = 0.0;
  for (int cycle = 0; cycle < 80; ++cycle) {
    velocity = std::min(1.0, velocity + 9.0 * 0.004);
    position += velocity * 0.004;
    ASSERT_EQ(world.command(position), "");
    (void)world.targets(1);
  }
  const std::int32_t last = world.targets(1).front();
  ASSERT_GT(world.targets(3).back(), last + 500) << "on its ramp, 10 rad/s² from 1 rad/s";
  const std::int32_t passed = world.drive().target_position;
  world.now += 50ms;
  for (const std::int32_t target : world.targets(100)) ASSERT_GE(target, passed);
}

TEST(AxisStream, OfVelocitiesHasARampThoughNoAccelerationIsConfigured) {
  config::RobotConfig config = shoulderIn("cyclic_velocity");
  config.axes[0].limits.acceleration.reset();
  StreamWorld world(config);
  world.drive().velocities.clear();
  ASSERT_EQ(world.command(1.0), "");
  world.run(160ms);
  const std::vector<std::int32_t>& velocities = world.drive().velocities;
  for (std::size_t i = 1; i < velocities.size(); ++i) {
    ASSERT_LE(std::abs(velocities[i] - velocities[i - 1]), 2000 + 1);  // 5 rad/s² * 4 ms
  }
  EXPECT_NEAR(velocities.back(), 80000, 4000);
}

TEST(AxisStream, OfAVelocityOrAnEffortIsKeptForAsLongAsTheTimeOutAllows) {
  for (const char* const mode : {"cyclic_velocity", "cyclic_torque"}) {
    SCOPED_TRACE(mode);
    StreamWorld world(mode);
    drive::Axis& axis = world.axis(0);
    ASSERT_TRUE(axis.command(0.5, world.now).ok());
    axis.writeCommands(world.now + 200ms);  // command_timeout
    EXPECT_FALSE(axis.stream().dried_up);
    axis.writeCommands(world.now + 200ms + 1us);
    EXPECT_TRUE(axis.stream().dried_up);
  }
}

TEST(AxisStream, IsNotAtRestFromTheFirstCycleOn) {
  for (const char* const mode : {"cyclic_position", "cyclic_velocity", "cyclic_torque"}) {
    SCOPED_TRACE(mode);
    StreamWorld world(mode);
    drive::Axis& axis = world.axis(0);
    axis.writeCommands(world.now);
    EXPECT_TRUE(axis.stream().at_rest);
    ASSERT_TRUE(axis.command(0.5, world.now).ok());
    axis.writeCommands(world.now);
    EXPECT_FALSE(axis.stream().at_rest);
  }
}

TEST(AxisStream, IsAtRestOnceItsStopHasEnded) {
  StreamWorld world("cyclic_position");
  drive::Axis& axis = world.axis(0);
  world.run(1ms);  // so that each cycle of the robot lies within a run
  ASSERT_TRUE(axis.command(2.0, world.now).ok());
  world.run(100 * test::kPeriod);
  axis.stopSetPoint();
  world.run(20 * test::kPeriod);
  EXPECT_FALSE(axis.stream().at_rest) << "2 rad/s at 10 rad/s² take 200 ms";
  world.run(40 * test::kPeriod);
  EXPECT_TRUE(axis.stream().at_rest);
}

TEST(AxisStream, IsAtRestWhenTheAxisFallsOutOfOperation) {
  StreamWorld world("cyclic_velocity");
  ASSERT_EQ(world.command(0.5), "");
  world.run(150ms);
  EXPECT_FALSE(world.shoulder().stream().at_rest);
  world.drive().fault(0x8611);
  world.run(20ms);
  EXPECT_TRUE(world.shoulder().stream().at_rest);
  EXPECT_FALSE(world.shoulder().stream().dried_up);
}

TEST(AxisStream, AGoalIsAtRestWhenTheDriveHasReachedIt) {
  StreamWorld world("profile_position");
  ASSERT_EQ(world.command(0.5), "");
  world.run(300ms);
  EXPECT_FALSE(world.shoulder().stream().at_rest);
  world.run(400ms);
  ASSERT_EQ(world.drive().position, 50000);
  EXPECT_TRUE(world.shoulder().stream().at_rest);
}

TEST(AxisStream, AGoalIsHeldBackToTheLowerLimitOfTheJoint) {
  StreamWorld world("profile_position");
  ASSERT_EQ(world.command(-99.0), "");
  world.run(4s);
  EXPECT_EQ(world.drive().position, -300000);
}

}  // namespace
}  // namespace cia402::bus
