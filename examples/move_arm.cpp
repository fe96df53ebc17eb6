// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A program of its own, without ROS: loads a robot, enables and homes it, sends a group of joints
// along a trajectory and prints where they are meanwhile.
//
//   move_arm CONFIG_FOLDER [ROBOT_FILE]      the demo robot with simulated drives, or a file of
//   yours
#include <cstdio>
#include <string>
#include <thread>

#include "cia402_driver/robot.h"

namespace {

using namespace std::chrono_literals;
using cia402::Procedure;
using cia402::Robot;

void print(const Robot& robot) {
  for (const cia402::JointStatus& joint : robot.state()) {
    std::printf("%s %+.3f (%s)  ", joint.name.c_str(), joint.position, joint.condition.c_str());
  }
  std::printf("\n");
}

/// Waits for an answer, and lets the robot tell meanwhile. @return what was answered
template <typename Answered>
Answered wait(Robot& robot, std::future<Answered> answer) {
  while (answer.wait_for(200ms) != std::future_status::ready) robot.poll();
  robot.poll();
  return answer.get();
}

bool run(Robot& robot, Procedure procedure) {
  const cia402::Answer answer = wait(robot, robot.run(procedure));
  std::printf("%s\n", answer.message.c_str());
  return answer.success;
}

/// Every joint of the group goes 0.2 rad (m) on from where it stands, and back.
bool swing(Robot& robot, const std::string& group) {
  cia402::motion::TrajectoryPoint there, back;
  const std::vector<std::string> joints = robot.jointsOf(group);
  for (const std::string& name : joints) {
    for (const cia402::JointStatus& joint : robot.state()) {
      if (joint.name != name) continue;
      there.positions.push_back(joint.position + 0.2);
      back.positions.push_back(joint.position);
    }
  }
  there.time_from_start = 1s;
  back.time_from_start = 2s;
  auto moving = robot.follow(group, joints, {there, back});
  while (moving.wait_for(250ms) != std::future_status::ready) print(robot);
  const cia402::bus::TrajectoryOutcome outcome = moving.get();
  std::printf("%s\n", outcome.message.c_str());
  return outcome.end == cia402::bus::TrajectoryEnd::reached;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: move_arm CONFIG_FOLDER [ROBOT_FILE]\n"), 2;
  Robot::Options options;
  options.config_folder = argv[1];
  options.log = [](const std::string& text) { std::printf("  %s\n", text.c_str()); };
  const std::string file = argc > 2 ? argv[2] : options.config_folder + "/robots/demo.yaml";
  auto loaded = Robot::load(file, options);
  if (!loaded) return std::fprintf(stderr, "%s\n", loaded.error().message.c_str()), 1;
  Robot& robot = loaded.value();
  robot.start();
  for (int i = 0; i < 100 && !robot.ready(); ++i) std::this_thread::sleep_for(100ms);
  if (!run(robot, Procedure::enable) || !run(robot, Procedure::home)) return 1;
  for (const std::string& group : robot.groups()) {
    if (!swing(robot, group)) return 1;
  }
  return run(robot, Procedure::disable) ? 0 : 1;
}
