// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using test::FakeDrive;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

config::RobotConfig oneAxis(const std::string& mode) {
  config::RobotConfig robot = test::testRobot();
  robot.axes.resize(1);
  robot.devices.resize(1);
  robot.axes[0].mode = mode;
  robot.groups[0].joints = {"shoulder"};
  return robot;
}

struct Rig {
  explicit Rig(const config::RobotConfig& config) : world(config) { world.enable(); }
  explicit Rig(const std::string& mode) : Rig(oneAxis(mode)) {}

  /// @return the refusal; empty if it was taken.
  std::string command(double value) {
    const auto answers = world.begin(SetpointCommand{0, value});
    return answers->empty() ? std::string() : answers->front().message;
  }
  FakeDrive& drive() { return world.drives[0]; }

  RobotWorld world;
};

int largestStep(const std::vector<std::int32_t>& values) {
  int largest = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    largest = std::max(largest, std::abs(values[i] - values[i - 1]));
  }
  return largest;
}

int largestChangeOfStep(const std::vector<std::int32_t>& values) {
  std::vector<std::int32_t> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  return largestStep(steps);
}

// 2 rad/s * 4 ms = 800 counts, 10 rad/s² * (4 ms)² = 16 counts, each rounded.
constexpr int kLargestStep = 800 + 1, kLargestChange = 16 + 2;

TEST(AxisCommands, LimitsAStreamedPositionInVelocityAndAcceleration) {
  Rig rig("cyclic_position");
  ASSERT_EQ(rig.command(2.0), "");
  rig.world.run(2s);
  EXPECT_EQ(rig.drive().targets.back(), 200000);
  EXPECT_LE(largestStep(rig.drive().targets), kLargestStep);
  EXPECT_LE(largestChangeOfStep(rig.drive().targets), kLargestChange);
  EXPECT_EQ(*std::max_element(rig.drive().targets.begin(), rig.drive().targets.end()), 200000);
}

config::RobotConfig smoothAxis(const std::string& mode) {
  config::RobotConfig robot = oneAxis(mode);
  robot.axes[0].limits.jerk = 50.0;  // 0.2 s to its acceleration
  return robot;
}

TEST(AxisCommands, LimitsAStreamedPositionInJerk) {
  Rig rig(smoothAxis("cyclic_position"));
  rig.drive().targets.clear();
  ASSERT_EQ(rig.command(2.0), "");
  rig.world.run(1360ms);
  EXPECT_LT(rig.drive().targets.back(), 200000);
  rig.world.run(100ms);  // 2 rad at 2 rad/s, 10 rad/s², 50 rad/s³: 1 + 0.2 + 0.2 s
  const std::vector<std::int32_t>& targets = rig.drive().targets;
  EXPECT_EQ(targets.back(), 200000);
  EXPECT_LE(largestStep(targets), kLargestStep);
  EXPECT_LE(largestChangeOfStep(targets), kLargestChange);
  const auto moves = std::find_if(targets.begin(), targets.end(), [](int t) { return t != 0; });
  ASSERT_LT(moves - targets.begin(), 20);
  // 50 rad/s³ * (4 ms)³ = 0.32 counts that a step changes by more with each step.
  for (std::size_t i = 2; i < 40; ++i) {
    const int change = targets[i] - 2 * targets[i - 1] + targets[i - 2];
    EXPECT_LE(change, 0.32 * static_cast<double>(i) + 2) << i;
  }
}

TEST(AxisCommands, LimitsAStreamedVelocityInJerk) {
  Rig rig(smoothAxis("cyclic_velocity"));
  ASSERT_EQ(rig.command(0.0), "");
  rig.drive().velocities.clear();
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(rig.command(1.5), "");
    rig.world.run(4ms);
  }
  EXPECT_NEAR(rig.drive().velocities.back(), 150000, 2);
  EXPECT_LE(largestStep(rig.drive().velocities), 4000 + 1);        // 10 rad/s² * 4 ms
  EXPECT_LE(largestChangeOfStep(rig.drive().velocities), 80 + 2);  // 50 rad/s³ * (4 ms)²
}

TEST(AxisCommands, StopsAStreamedPositionAtTheLimitOfTheJoint) {
  Rig rig("cyclic_position");
  ASSERT_EQ(rig.command(10.0), "");
  rig.world.run(4s);
  EXPECT_EQ(rig.drive().position, 300000);
}

TEST(AxisCommands, StopsAStreamedPositionAtTheLowerLimitToo) {
  Rig rig("cyclic_position");
  ASSERT_EQ(rig.command(-10.0), "");
  rig.world.run(4s);
  EXPECT_EQ(rig.drive().position, -300000);
}

TEST(AxisCommands, AJointHasTheLimitsAndTheUnitOfItsAxis) {
  drive::AxisConfig config = test::testAxis("lift", 3);
  config.joint = "lift_joint";
  config.limits.lower = -0.1;
  config.limits.upper = 0.7;
  config.limits.velocity = 0.5;
  config.limits.acceleration = 3.0;
  config.limits.jerk = 40.0;
  config.limits.effort = 120.0;
  config.geometry.type = drive::AxisGeometry::Type::prismatic;
  const motion::Joint lift = jointOf(config);
  EXPECT_EQ(lift.name, "lift_joint");
  EXPECT_EQ(lift.limits.lower, -0.1);
  EXPECT_EQ(lift.limits.upper, 0.7);
  EXPECT_EQ(lift.limits.velocity, 0.5);
  EXPECT_EQ(lift.limits.acceleration, 3.0);
  EXPECT_EQ(lift.limits.jerk, 40.0);
  EXPECT_EQ(lift.limits.effort, 120.0);
  EXPECT_FALSE(lift.limits.continuous);
  EXPECT_EQ(lift.unit, motion::JointUnit::metre);
  config.geometry.type = drive::AxisGeometry::Type::continuous;
  EXPECT_TRUE(jointOf(config).limits.continuous);
  EXPECT_EQ(jointOf(config).unit, motion::JointUnit::radian);
}

TEST(AxisCommands, GoesOnSmoothlyToItsGoalAfterMissedCycles) {
  Rig rig("cyclic_position");
  ASSERT_EQ(rig.command(1.0), "");
  rig.world.run(300ms);  // at 2 rad/s
  rig.world.now += 50ms;
  rig.world.run(4ms);
  rig.drive().targets.clear();
  rig.world.run(2s);
  EXPECT_EQ(rig.drive().targets.back(), 100000);
  EXPECT_LE(largestStep(rig.drive().targets), kLargestStep);
  EXPECT_LE(largestChangeOfStep(rig.drive().targets), kLargestChange);
}

TEST(AxisCommands, DoesNotGoOnBehindAMotorThatStoodInItsWay) {
  Rig rig("cyclic_position");
  ASSERT_EQ(rig.command(1.0), "");
  rig.world.run(100ms);
  rig.drive().blocked = true;
  rig.world.run(1s);  // its set-point was called back
  rig.drive().blocked = false;
  rig.world.run(20ms);
  const std::int32_t position = rig.drive().position;
  EXPECT_LT(position, 50000);
  rig.world.run(1s);
  EXPECT_EQ(rig.drive().position, position);
}

TEST(AxisCommands, RampsAStreamedVelocityUpAndStopsItByARampWhenTheStreamDriesUp) {
  Rig rig("cyclic_velocity");
  for (int i = 0; i < 25; ++i) {
    ASSERT_EQ(rig.command(1.0), "");
    rig.world.run(20ms);
  }
  EXPECT_EQ(rig.drive().target_velocity, 100000);
  rig.world.run(170ms);  // the last command is 190 ms old, command_timeout is 200 ms
  EXPECT_EQ(rig.drive().target_velocity, 100000);
  rig.world.run(60ms);
  EXPECT_GT(rig.drive().target_velocity, 0);  // on the ramp: 1 rad/s at 10 rad/s² take 100 ms
  EXPECT_LT(rig.drive().target_velocity, 100000);
  rig.world.run(100ms);
  EXPECT_EQ(rig.drive().target_velocity, 0);
  EXPECT_LE(largestStep(rig.drive().velocities), 4000 + 1);  // 10 rad/s² * 4 ms
}

TEST(AxisCommands, StopsAStreamedVelocityBeforeThePositionLimit) {
  Rig rig("cyclic_velocity");
  for (int i = 0; i < 200; ++i) {
    (void)rig.command(2.0);
    rig.world.run(20ms);
  }
  EXPECT_LE(rig.drive().position, 300000);
  EXPECT_GT(rig.drive().position, 290000);
  EXPECT_LT(rig.drive().target_velocity, 1000);  // 0.01 rad/s, creeping up to it
}

TEST(AxisCommands, ClampsATorqueAndDropsItWhenTheStreamDriesUp) {
  Rig rig("cyclic_torque");
  ASSERT_EQ(rig.command(8.0), "");
  rig.world.run(50ms);
  EXPECT_EQ(rig.drive().target_torque, 500);  // 5 N m of 10 N m in 1/1000
  ASSERT_EQ(rig.command(-8.0), "");
  rig.world.run(50ms);
  EXPECT_EQ(rig.drive().target_torque, -500);
  rig.world.run(170ms);
  EXPECT_EQ(rig.drive().target_torque, 0);
}

TEST(AxisCommands, SaysThatAStreamDriedUpUnlessItEndedWithAZero) {
  for (const char* const mode : {"cyclic_velocity", "cyclic_torque"}) {
    for (const double last : {0.5, 0.0}) {
      SCOPED_TRACE(std::string(mode) + " that ends with " + std::to_string(last));
      config::RobotConfig config = oneAxis(mode);
      config.axes[0].brake_after_effort = false;  // it coasts, and stays as it is
      Rig rig(config);
      ASSERT_EQ(rig.command(0.5), "");
      rig.world.run(20ms);
      ASSERT_EQ(rig.command(last), "");
      rig.world.run(190ms);  // command_timeout is 200 ms
      EXPECT_FALSE(rig.world.axis(0).stream().dried_up);
      rig.world.run(20ms);
      EXPECT_EQ(rig.world.axis(0).stream().dried_up, last != 0.0);
    }
  }
}

TEST(AxisCommands, HandsAProfilePositionToTheDriveWithinTheLimits) {
  Rig rig("profile_position");
  ASSERT_EQ(rig.command(0.5), "");
  rig.world.run(1s);
  EXPECT_EQ(rig.drive().position, 50000);
  ASSERT_EQ(rig.command(99.0), "");
  rig.world.run(4s);
  EXPECT_EQ(rig.drive().position, 300000);
}

TEST(AxisCommands, DisablesADriveThatPlansItsMotionAtOnceAtShutdown) {
  Rig rig("profile_position");
  ASSERT_EQ(rig.command(2.0), "");
  rig.world.run(500ms);
  const std::int32_t position = rig.drive().position;
  ASSERT_GT(position, 10000);
  rig.world.network.beginShutdown(rig.world.now);
  rig.world.run(100ms);
  EXPECT_FALSE(rig.drive().enabled());
  EXPECT_LT(rig.drive().position, position + 3000);  // 30 ms at 1 rad/s
}

TEST(AxisCommands, RampsAPositionStreamDownThoughNoAccelerationIsConfigured) {
  config::RobotConfig config = oneAxis("cyclic_position");
  config.axes[0].limits.acceleration.reset();
  Rig rig(config);
  ASSERT_EQ(rig.command(2.9), "");
  rig.world.run(500ms);
  rig.drive().targets.erase(rig.drive().targets.begin(), rig.drive().targets.end() - 3);
  const std::int32_t from = rig.drive().targets.back();
  rig.world.network.beginShutdown(rig.world.now);
  ASSERT_TRUE(rig.world.runUntil([&] { return rig.world.network.shutDown(); }, 2s));
  EXPECT_LE(largestStep(rig.drive().targets), kLargestStep);
  EXPECT_LE(largestChangeOfStep(rig.drive().targets), 8 + 2);  // 5 rad/s² * (4 ms)²
  // 2 rad/s at 5 rad/s² take 0.4 rad.
  EXPECT_NEAR(rig.drive().targets.back() - from, 40000, 800);
}

TEST(AxisCommands, GoesOnSmoothlyAfterAStop) {
  Rig rig("cyclic_position");
  drive::Axis& axis = rig.world.axis(0);
  const auto run = [&](int cycles) { rig.world.run(cycles * test::kPeriod); };
  rig.world.run(1ms);  // so that each cycle of the robot lies within a run
  ASSERT_TRUE(axis.command(2.0, rig.world.now).ok());
  run(100);
  axis.stopSetPoint();
  run(20);
  EXPECT_FALSE(axis.stream().at_rest);
  ASSERT_TRUE(axis.command(2.0, rig.world.now).ok());
  run(300);
  EXPECT_TRUE(axis.stream().at_rest);
  EXPECT_EQ(rig.drive().targets.back(), 200000);
  EXPECT_LE(largestStep(rig.drive().targets), kLargestStep);
  EXPECT_LE(largestChangeOfStep(rig.drive().targets), kLargestChange);
}

TEST(AxisCommands, RefusesWhatCannotBeDoneInWords) {
  Rig rig("cyclic_position");
  EXPECT_EQ(rig.command(std::numeric_limits<double>::quiet_NaN()),
            "shoulder: set-point refused: it is not a finite number");
  ASSERT_TRUE(rig.world.move({1.0}, 1.0).success);
  EXPECT_EQ(rig.command(1.0),
            "shoulder: set-point refused: the axis follows a trajectory of group arm; stop that "
            "first with an empty trajectory");
  rig.world.run(2s);
  EXPECT_EQ(rig.command(1.0), "");
  ASSERT_TRUE(rig.world.call(drive::ProcedureKind::disable).success);
  EXPECT_THAT(rig.command(1.0), AllOf(HasSubstr("shoulder (node 1)"), HasSubstr("not enabled")));
}

TEST(AxisCommands, ForgetsACommandWhenTheAxisIsDisabled) {
  Rig rig("cyclic_position");
  ASSERT_EQ(rig.command(2.0), "");
  rig.world.run(400ms);
  ASSERT_TRUE(rig.world.call(drive::ProcedureKind::disable).success);
  ASSERT_TRUE(rig.world.call(drive::ProcedureKind::enable).success);
  const std::int32_t position = rig.drive().position;
  rig.world.run(500ms);
  EXPECT_EQ(rig.drive().position, position);
}

}  // namespace
}  // namespace cia402::bus
