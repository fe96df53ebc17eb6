// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/robot_loader.h"

#include <ros/console.h>
#include <ros/package.h>

#include <utility>

#include "config/ready_robot.h"

namespace cia402::ros_node {
namespace {

std::string packageFolder(const std::string& folder) {
  return ros::package::getPath("cia402_driver") + "/config/" + folder;
}

// "package://my_robot/drives/motor.eds", or what config::profilesIn() finds.
config::ProfileLookup lookup(std::vector<std::string> folders) {
  return [plain = config::profilesIn(std::move(folders))](const std::string& name) -> std::string {
    static const std::string kScheme = "package://";
    if (name.compare(0, kScheme.size(), kScheme) != 0) return plain(name);
    const std::size_t slash = name.find('/', kScheme.size());
    if (slash == std::string::npos) return "";
    const std::string package = name.substr(kScheme.size(), slash - kScheme.size());
    const std::string folder = ros::package::getPath(package);
    return folder.empty() ? "" : plain(folder + name.substr(slash));
  };
}

bool report(const Problems& problems, const std::string& where) {
  if (problems.empty()) return false;
  ROS_FATAL_STREAM(problems.list().size()
                   << (problems.list().size() == 1 ? " problem" : " problems") << " in the "
                   << where << "; nothing was sent to the bus:\n"
                   << problems.text());
  return true;
}

}  // namespace

std::optional<LoadedRobot> loadRobot(const ros::NodeHandle& private_node) {
  Problems problems;
  Parameters parameters = readParameters(private_node, problems);
  std::vector<std::string> folders = {packageFolder("drives")};
  if (!parameters.options.profile_path.empty()) {
    folders.insert(folders.begin(), parameters.options.profile_path);
  }
  const config::ProfileLookup found = lookup(folders);
  auto ready = config::readyRobot(parameters.robot, found, problems);
  report(problems, "configuration of " + private_node.getNamespace());
  if (!ready) return std::nullopt;
  for (const std::string& warning : ready->robot.warnings) ROS_WARN_STREAM(warning);
  for (const std::string& note : ready->robot.notes) ROS_INFO_STREAM(note);
  return LoadedRobot{parameters.options, std::move(ready->robot), std::move(ready->master),
                     parameters.robot, found};
}

std::optional<std::vector<sim::SimulatedDrive>> loadSimulation(const config::RobotConfig& robot) {
  Problems problems;
  auto drives = sim::simulatedDrives(robot, packageFolder("simulated_drives"), problems);
  if (report(problems, "simulation")) return std::nullopt;
  return drives;
}

}  // namespace cia402::ros_node
