// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/reload.h"

namespace cia402::config {
namespace {

constexpr double kMuch = 1e3;  // for tools that show a range: no range of the file's

struct Collected {
  std::vector<Tunable> all;
  void number(const std::string& key, double value, double high, const char* meaning) {
    all.push_back({key, false, value, 0.0, high, meaning});
  }
  void flag(const std::string& key, bool value, const char* meaning) {
    all.push_back({key, true, value ? 1.0 : 0.0, 0.0, 1.0, meaning});
  }
};

void addGroup(const GroupConfig& group, Collected& to) {
  const std::string key = "groups/" + group.name + "/", constraints = key + "constraints/";
  to.number(constraints + "goal_time", group.goal_time, kMuch,
            "s to arrive, and to come to rest, after a trajectory's end");
  to.number(constraints + "stopped_velocity_tolerance", group.stopped_velocity_tolerance, kMuch,
            "rad/s or m/s, below which a motor stands; 0: not waited for");
  to.number(key + "stop_trajectory_duration", group.stop_trajectory_duration, kMuch,
            "s that the stop of a cancelled trajectory takes at least");
  to.flag(key + "allow_partial_joints_goal", group.allow_partial_joints_goal,
          "trajectories may leave joints out");
  for (const std::string& joint : group.joints) {
    const auto found = group.tolerances.find(joint);
    const JointTolerance none;
    const JointTolerance& tolerance = found == group.tolerances.end() ? none : found->second;
    to.number(constraints + joint + "/trajectory", tolerance.trajectory, kMuch,
              "rad or m off its path; 0: not checked");
    to.number(constraints + joint + "/goal", tolerance.goal, kMuch,
              "rad or m off its goal; 0: not checked");
  }
}

void addAxis(const drive::AxisConfig& axis, Collected& to) {
  const std::string key = "axes/" + axis.name + "/";
  to.number(key + "command_timeout", toSeconds(axis.command_timeout), 60.0,
            "s after which a streamed velocity or effort ends");
  if (!axis.position_loop) return;
  to.number(key + "position_loop/gain", axis.position_loop->gain,
            drive::PositionLoop::kLargestStep / toSeconds(axis.cycle),
            "1/s, velocity for the distance to the set-point");
  to.number(key + "position_loop/feed_forward", axis.position_loop->feed_forward, 2.0,
            "share of the set-point's velocity");
}

}  // namespace

std::vector<Tunable> tunablesOf(const RobotConfig& robot) {
  Collected all;
  all.number("joint_state_rate", robot.joint_state_rate, 1000.0, "Hz of joint_states and tf");
  for (const GroupConfig& group : robot.groups) addGroup(group, all);
  for (const drive::AxisConfig& axis : robot.axes) addAxis(axis, all);
  return all.all;
}

}  // namespace cia402::config
