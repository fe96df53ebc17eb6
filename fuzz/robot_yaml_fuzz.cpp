// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <string>

#include "config/robot.h"
#include "input.h"

// Robot configurations of any YAML: problems, never a crash. What has none makes a master's
// configuration.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cia402;
  YAML::Node tree;
  try {
    tree = YAML::Load(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const YAML::Exception&) {
    return 0;  // readRobotFile() tells it
  }
  // An EDS is not read from here: eds_fuzz does it.
  static const config::ProfileLookup kLookup = [](const std::string& name) -> std::string {
    if (name == "generic_cia402" || name == "damiao_dm") {
      return std::string(CIA402_CONFIG_DIR) + "/drives/" + name + ".yaml";
    }
    return "";
  };
  Problems problems;
  const config::RobotConfig robot = config::loadRobot(tree, kLookup, problems);
  if (!problems.empty()) return 0;
  fuzz::require(!robot.axes.empty(), "a robot has an axis");
  const canopen::MasterConfig master = config::makeMasterConfig(robot, problems);
  if (!problems.empty()) return 0;
  fuzz::require(master.nodes.size() == robot.axes.size(), "an axis is a node");
  config::pdoTable(master, robot.bus.bitrate);
  return 0;
}
