// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "system/robot_fixture.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

TEST(DemoRobot, BootsEnablesHomesAndFollowsATrajectory) {
  const LoadedRobot loaded = loadFile("demo.yaml");
  tools::VirtualRobot robot(loaded.robot, loaded.master, loaded.drives);
  robot.start();
  ASSERT_TRUE(robot.runUntil([&] { return allReady(robot); }, 5s)) << told(robot);

  const auto homed = robot.procedure(ProcedureKind::home);
  ASSERT_TRUE(homed.has_value());
  ASSERT_TRUE(homed->success) << homed->message << "\n" << told(robot);
  const auto enabled = robot.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.has_value());
  ASSERT_TRUE(enabled->success) << enabled->message;

  bus::TrajectoryCommand trajectory;
  const config::GroupConfig& group = loaded.robot.groups.front();
  trajectory.group = group.name;
  trajectory.joints = group.joints;
  const std::vector<double> goal(group.joints.size(), 0.3);
  trajectory.points = {{goal, std::vector<double>(goal.size(), 0.0), {}, 4s}};
  const auto accepted = robot.call(trajectory);
  ASSERT_TRUE(accepted.has_value());
  ASSERT_TRUE(accepted->success) << accepted->message;
  robot.run(5s);
  for (const bus::AxisUnit& unit : robot.network().cycle().units()) {
    const drive::Axis& axis = unit.axis;
    EXPECT_NEAR(axis.state().position, 0.3, 1e-3) << axis.config().name;
  }
  EXPECT_THAT(told(robot), HasSubstr("goal reached"));
}

}  // namespace
}  // namespace cia402
