// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "config/robot_parts.h"

namespace cia402::config {
namespace {

/// Before anything is read: what is wrong with it is told then.
void countAxes(const YAML::Node& axis, AxisReading& reading) {
  const YAML::Node node = axis.IsMap() ? axis["node_id"] : YAML::Node();
  const auto id = node && node.IsScalar() ? yaml::parseInteger(node.Scalar()) : std::nullopt;
  if (id && *id >= 1 && *id <= 127) ++reading.axes_of[static_cast<canopen::NodeId>(*id)];
}

void readAxes(const yaml::Value& value, const YAML::Node& defaults, AxisReading& reading,
              RobotConfig& robot) {
  yaml::Section section(value);
  for (const auto& [name, entry] : section.entries()) countAxes(entry.node(), reading);
  for (const auto& [name, entry] : section.entries()) {
    const yaml::Value merged(mergeDefaults(defaults, entry.node()), entry.path(), entry.problems());
    readAxis(name, merged, reading, robot);
  }
  section.finish();
  if (robot.axes.empty()) value.problem("must name at least one axis");
}

RobotConfig readRobot(const YAML::Node& tree, const ProfileLookup& lookup, Problems& problems) {
  RobotConfig robot;
  AxisReading reading{ProfileCache(lookup, problems), EdsFiles(lookup), {}, {}, {}, {}};
  const yaml::Value root(tree, "", problems);
  yaml::Section section(root);
  const yaml::Value missing(YAML::Node(YAML::NodeType::Map), "bus", problems);
  bool counter_given = false;

  const auto bus = section.get("bus");
  readBus(bus.value_or(missing), robot.bus, counter_given);
  const auto defaults = section.get("defaults");
  if (defaults) yaml::Section check_kind(*defaults);
  section.read("joint_state_rate", robot.joint_state_rate, yaml::Range{0.0, 1000.0, true});
  if (const auto unknown = section.get("unknown_joints")) {
    robot.omit_unknown_joints = unknown->oneOf({"nan", "omit"}) == 1U;
  }
  const auto described = section.get("limits_from");
  if (described) reading.described = DescribedLimits(*described);
  reading.coupled = coupledAxes(tree);
  const auto axes = section.get("axes");
  if (axes) {
    readAxes(*axes, defaults ? defaults->node() : YAML::Node(), reading, robot);
  } else {
    problems.add("axes", "is missing: name at least one axis with its node_id and drive");
  }
  if (const auto couplings = section.get("couplings")) {
    readCouplings(*couplings, reading.described, robot);
  }
  reading.described.finish(jointNames(robot));
  readTf(section, robot);
  const auto groups = section.get("groups");
  if (groups && !groups->node().IsNull()) readGroups(*groups, robot);
  if (robot.groups.empty()) addDefaultGroup(robot);
  if (const auto recorder = section.get("recorder")) readRecorder(*recorder, robot.recorder);
  section.finish();

  checkSync(bus.value_or(missing), counter_given, robot);
  if (problems.empty()) checkBusLoad(bus.value_or(missing), robot, problems);
  return robot;
}

}  // namespace

ProfileLookup profilesIn(std::vector<std::string> folders) {
  return [folders = std::move(folders)](const std::string& name) -> std::string {
    const std::size_t dot = name.find_last_of("./");
    const std::string ending = dot == std::string::npos ? "" : fieldbus::nameKey(name.substr(dot));
    const bool is_path = name.find('/') != std::string::npos || ending == ".yaml" ||
                         ending == ".eds" || ending == ".dcf";
    if (is_path && std::ifstream(name)) return name;
    for (const std::string& folder : folders) {
      const std::string path = folder + "/" + name + (is_path ? "" : ".yaml");
      if (std::ifstream(path)) return path;
    }
    return "";
  };
}

YAML::Node readRobotFile(const std::string& path, Problems& problems) {
  try {
    return yaml::parseFile(path);
  } catch (const YAML::BadFile&) {
    problems.add(path, "cannot be read");
  } catch (const YAML::Exception& error) {
    problems.add(path + ":" + std::to_string(error.mark.line + 1), "is no YAML: " + error.msg);
  }
  return YAML::Node();
}

RobotConfig loadRobot(const YAML::Node& tree, const ProfileLookup& profiles, Problems& problems) {
  if (!tree.IsMap()) {
    problems.add("configuration", "is empty or no mapping; it needs `bus` and `axes`");
    return {};
  }
  Problems found;
  RobotConfig robot = readRobot(tree, profiles, found);
  nameDefaults(tree, found, problems);
  return robot;
}

}  // namespace cia402::config
