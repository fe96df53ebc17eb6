// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/text.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

constexpr yaml::Range kShare{0.0, 1.0, false};

// Whether the drive has room for a stream of positions.
bool streamsPositions(const drive::AxisConfig& axis) {
  if (!axis.profile || axis.outputs.empty()) return true;  // told elsewhere
  return drive::trajectoryMode(axis) != nullptr;
}

// Why an axis cannot follow trajectories, and what to do.
std::string incapacity(const RobotConfig& robot, const std::string& name) {
  const auto axis = std::find_if(robot.axes.begin(), robot.axes.end(),
                                 [&](const drive::AxisConfig& a) { return a.name == name; });
  const std::string cannot = "`" + name + "` cannot follow trajectories: ";
  const auto& modes = axis->profile->modes;
  const auto mode = std::find_if(modes.begin(), modes.end(), [](const drive::ModeSpec& candidate) {
    return candidate.cyclic && candidate.kind == drive::ControlKind::position;
  });
  if (mode == modes.end()) {
    return cannot + "its profile has no cyclic position mode; leave its joint out of the group";
  }
  const std::string where = "axes/" + name + "/";
  const std::string add = robot.pdosOf(*axis).planned
                              ? "add " + mode->name + " to `" + where + "modes`"
                              : "map " + mode->target + " into an RPDO in `" + where + "pdos`";
  return cannot + "no RPDO holds the target of its mode " + mode->name + "; " + add +
         ", or leave its joint out of the group";
}

std::vector<std::string> incapableAxes(const RobotConfig& robot, const std::string& joint) {
  std::vector<std::string> incapable;
  for (const drive::AxisConfig& axis : robot.axes) {
    if (robot.turns(axis, joint) && !streamsPositions(axis)) incapable.push_back(axis.name);
  }
  return incapable;
}

void readConstraints(const yaml::Value& value, GroupConfig& group) {
  yaml::Section section(value);
  section.read("goal_time", group.goal_time, yaml::kNotNegative);
  section.read("stopped_velocity_tolerance", group.stopped_velocity_tolerance, yaml::kNotNegative);
  for (const std::string& joint : group.joints) {
    const auto tolerance = section.get(joint);
    if (!tolerance) continue;
    yaml::Section tolerance_section(*tolerance);
    JointTolerance& target = group.tolerances[joint];
    tolerance_section.read("trajectory", target.trajectory, yaml::kNotNegative);
    tolerance_section.read("goal", target.goal, yaml::kNotNegative);
    tolerance_section.finish();
  }
  section.finish();
}

/// Joints that axes couple move together or not at all.
void checkWhole(yaml::Section& section, const RobotConfig& robot, const GroupConfig& group) {
  const auto in = [&](const motion::Joint& joint) {
    return std::find(group.joints.begin(), group.joints.end(), joint.name) != group.joints.end();
  };
  for (const CouplingConfig& coupling : robot.couplings) {
    const auto missing = std::find_if_not(coupling.joints.begin(), coupling.joints.end(), in);
    const bool any = std::any_of(coupling.joints.begin(), coupling.joints.end(), in);
    if (!any || missing == coupling.joints.end()) continue;
    section.get("joints")->problem("lacks `" + missing->name + "`, which the same axes move (" +
                                   joined(coupling.axes, ", ") +
                                   "): joints of a coupling are in a group together");
  }
}

bool isAxisName(const RobotConfig& robot, const std::string& name) {
  return std::any_of(robot.axes.begin(), robot.axes.end(),
                     [&](const drive::AxisConfig& axis) { return axis.name == name; });
}

}  // namespace

std::vector<std::string> readNames(yaml::Section& section, const std::string& key,
                                   const std::vector<std::string>& known, const char* what) {
  std::vector<std::string> names;
  const auto list = section.require(key, std::string("list the ") + what + "s");
  if (!list) return names;
  for (const yaml::Value& value : list->list()) {
    const auto name = value.text();
    if (!name) continue;
    if (!known.empty() && std::find(known.begin(), known.end(), *name) == known.end()) {
      value.problem("there is no " + std::string(what) + " `" + *name + "`" +
                    yaml::suggestion(*name, known));
    } else if (std::find(names.begin(), names.end(), *name) != names.end()) {
      value.problem("`" + *name + "` is listed twice");
    } else {
      names.push_back(*name);
    }
  }
  if (list->isList() && list->node().size() == 0) list->problem("must not be empty");
  return names;
}

std::vector<std::string> jointNames(const RobotConfig& robot) {
  std::vector<std::string> names;
  for (const motion::Joint& joint : robot.joints()) names.push_back(joint.name);
  return names;
}

void readGroups(const yaml::Value& value, RobotConfig& robot) {
  const std::vector<std::string> known = jointNames(robot);
  yaml::Section groups(value);
  for (const auto& [name, entry] : groups.entries()) {
    GroupConfig group;
    group.name = name;
    if (!isGraphName(name)) {
      entry.problem("a group is named by a letter, then letters, digits and _");
    }
    if (isAxisName(robot, name)) {
      entry.problem("is the name of an axis, too; their topics would be the same");
    }
    yaml::Section section(entry);
    group.joints = readNames(section, "joints", known, "joint");
    section.read("stop_group_on_fault", group.stop_group_on_fault);
    section.read("allow_partial_joints_goal", group.allow_partial_joints_goal);
    section.read("stop_trajectory_duration", group.stop_trajectory_duration, yaml::kNotNegative);
    section.read("strict", group.strict);
    section.read("acceleration_margin", group.acceleration_margin, kShare);
    section.read("lengthening", group.lengthening, yaml::kNotNegative);
    if (const auto constraints = section.get("constraints")) readConstraints(*constraints, group);
    section.finish();
    checkWhole(section, robot, group);
    for (const std::string& joint : group.joints) {
      for (const std::string& axis : incapableAxes(robot, joint)) {
        section.get("joints")->problem(incapacity(robot, axis));
      }
    }
    robot.groups.push_back(group);
  }
  groups.finish();
}

void addDefaultGroup(RobotConfig& robot) {
  GroupConfig group;
  group.name = "joints";
  for (const std::string& joint : jointNames(robot)) {
    if (incapableAxes(robot, joint).empty()) group.joints.push_back(joint);
  }
  if (!group.joints.empty()) robot.groups.push_back(group);
}

}  // namespace cia402::config
