// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "robots.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace cia402::benchmark {
namespace {

constexpr double kAmplitude = 0.5, kRampTime = 2.0;  // rad, s

/// Turns per second that are no multiples of each other.
double frequency(std::size_t joint) { return 0.2 + 0.013 * static_cast<double>(joint); }

/// Rises smoothly from 0 to 1.
double blend(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
}

double sine(std::size_t joint, double time_s, double duration_s) {
  constexpr double kTwoPi = 6.283185307179586;
  const double envelope =
      blend(time_s / kRampTime) * blend((duration_s - time_s) / kRampTime + 1.0);
  return kAmplitude * envelope * std::sin(kTwoPi * frequency(joint) * time_s);
}

std::string description(int axes, double sync_period_s, Layout layout) {
  std::string text =
      "bus: {interface: sim, bitrate: 1000000, heartbeat: 0.5, sync_period: " +
      std::to_string(sync_period_s) +
      "}\n"
      "defaults: {type: revolute, mode: cyclic_position, drive: generic_cia402,\n"
      "  counts_per_turn: 131072, gear_ratio: 50, rated_torque: 0.64,\n"
      "  limits: {lower: -2.5, upper: 2.5, velocity: 4.0, acceleration: 20.0, effort: 30.0}";
  if (layout == Layout::lean) {
    text +=
        ",\n  pdos: {rpdo1: [controlword, target_position],"
        " tpdo1: [statusword, position_actual, mode_display]}";
  }
  text += "}\naxes:\n";
  std::string joints;
  for (int i = 1; i <= axes; ++i) {
    const std::string name = "joint" + std::to_string(i);
    text += "  " + name + ": {node_id: " + std::to_string(i) + "}\n";
    joints += (joints.empty() ? "" : ", ") + name;
  }
  return text + "groups: {all: {joints: [" + joints + "]}}\n";
}

}  // namespace

TestRobot genericRobot(int axes, double sync_period_s, Layout layout) {
  TestRobot result;
  Problems problems;
  const std::string folder = CIA402_CONFIG_DIR;
  const YAML::Node tree = YAML::Load(description(axes, sync_period_s, layout));
  result.robot = config::loadRobot(tree, config::profilesIn({folder + "/drives"}), problems);
  if (problems.empty()) result.master = config::makeMasterConfig(result.robot, problems);
  if (problems.empty()) {
    result.drives = sim::simulatedDrives(result.robot, folder + "/simulated_drives", problems);
  }
  if (!problems.empty()) throw std::runtime_error(problems.text());
  return result;
}

double swingPosition(std::size_t joint, double time_s) { return sine(joint, time_s, time_s); }

bus::TrajectoryCommand swing(const config::RobotConfig& robot, double duration_s, double period_s) {
  constexpr double kStep = 1e-3;  // s, of the difference quotients
  bus::TrajectoryCommand trajectory;
  trajectory.group = "all";
  for (const drive::AxisConfig& axis : robot.axes) trajectory.joints.push_back(axis.joint);
  const int last = static_cast<int>(std::ceil((duration_s + kRampTime) / period_s));
  for (int i = 1; i <= last; ++i) {
    const double time = i * period_s;
    motion::TrajectoryPoint point;
    point.time_from_start = fromSeconds(time);
    for (std::size_t j = 0; j < robot.axes.size(); ++j) {
      const double before = sine(j, time - kStep, duration_s), at = sine(j, time, duration_s),
                   after = sine(j, time + kStep, duration_s);
      point.positions.push_back(at);
      point.velocities.push_back(i == last ? 0.0 : (after - before) / (2.0 * kStep));
      point.accelerations.push_back(i == last ? 0.0
                                              : (after - 2.0 * at + before) / (kStep * kStep));
    }
    trajectory.points.push_back(std::move(point));
  }
  return trajectory;
}

}  // namespace cia402::benchmark
