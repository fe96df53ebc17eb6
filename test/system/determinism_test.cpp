// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdint>

#include "system/robot_fixture.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;

struct SeenFrame {
  Time time;
  can::Frame frame;
};
bool operator==(const SeenFrame& a, const SeenFrame& b) {
  return a.time == b.time && a.frame == b.frame;
}

/// What a run left: every frame on the bus with its time, and where the joints stand at the end.
struct Recording {
  std::vector<SeenFrame> frames;
  std::vector<double> positions;
};

/// Joints from -0.4 to 0.4 rad and back every four seconds, for a minute.
bus::TrajectoryCommand swing(const config::RobotConfig& robot) {
  bus::TrajectoryCommand trajectory;
  trajectory.group = robot.groups.front().name;
  trajectory.joints = robot.groups.front().joints;
  const std::size_t joints = trajectory.joints.size();
  for (int i = 1; i <= 30; ++i) {
    const std::vector<double> goal(joints, i % 2 == 0 ? 0.4 : -0.4), rest(joints, 0.0);
    trajectory.points.push_back({goal, rest, {}, i * 2s});
  }
  return trajectory;
}

/// A minute of three moving axes on a bus that loses and destroys frames.
Recording minuteWithFaults(std::uint64_t seed) {
  const LoadedRobot loaded = loadTree(YAML::Load(R"(
bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}
defaults: {drive: generic_cia402, type: revolute, mode: cyclic_position, counts_per_turn: 131072,
  gear_ratio: 50, rated_torque: 0.64,
  limits: {lower: -2.5, upper: 2.5, velocity: 2.0, acceleration: 10.0, effort: 30.0}}
axes: {shoulder: {node_id: 1}, elbow: {node_id: 2}, wrist: {node_id: 3}}
groups: {arm: {joints: [shoulder, elbow, wrist]}}
)"));
  tools::VirtualRobot robot(loaded.robot, loaded.master, loaded.drives, seed);
  Recording run;
  robot.world().bus().setMonitor([&run](const can::Frame& frame, Time time) {
    run.frames.push_back({time, frame});
  });
  robot.start();
  EXPECT_TRUE(robot.runUntil([&] { return allReady(robot); }, 5s)) << told(robot);
  const auto enabled = robot.procedure(drive::ProcedureKind::enable);
  EXPECT_TRUE(enabled && enabled->success) << told(robot);
  sim::FaultRates rates;
  rates.loss = rates.corrupt = 1e-3;
  robot.world().bus().faults().setRates(rates);
  const auto accepted = robot.call(swing(loaded.robot));
  EXPECT_TRUE(accepted && accepted->success) << told(robot);
  robot.run(59s);
  for (const bus::AxisUnit& unit : robot.network().cycle().units()) {
    const drive::Axis& axis = unit.axis;
    EXPECT_TRUE(axis.state().ready_for_motion) << told(robot);
    run.positions.push_back(axis.state().position);
  }
  return run;
}

TEST(VirtualTime, RunsTheSameTwiceWithOneSeedThoughTheBusLosesFrames) {
  const Recording first = minuteWithFaults(1), again = minuteWithFaults(1);
  EXPECT_GT(first.frames.size(), 59u * 250u * 7u);
  EXPECT_TRUE(first.frames == again.frames);
  EXPECT_EQ(first.positions, again.positions);
}

TEST(VirtualTime, RunsDifferentlyWithAnotherSeed) {
  EXPECT_FALSE(minuteWithFaults(1).frames == minuteWithFaults(2).frames);
}

}  // namespace
}  // namespace cia402
