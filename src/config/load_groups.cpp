// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include "config/robot_parts.h"

namespace cia402::config {
namespace {

constexpr yaml::Range kShare{0.0, 1.0, false};

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

/// The magnitude of the determinant.
double determinant(std::vector<std::vector<double>> m) {
  double product = 1.0;
  for (std::size_t column = 0; column < m.size(); ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < m.size(); ++row) {
      if (std::fabs(m[row][column]) > std::fabs(m[pivot][column])) pivot = row;
    }
    if (m[pivot][column] == 0.0) return 0.0;
    std::swap(m[pivot], m[column]);
    product *= m[column][column];
    for (std::size_t row = column + 1; row < m.size(); ++row) {
      const double factor = m[row][column] / m[column][column];
      for (std::size_t i = column; i < m.size(); ++i) m[row][i] -= factor * m[column][i];
    }
  }
  return std::fabs(product);
}

void readMatrix(yaml::Section& section, CouplingConfig& coupling) {
  const auto value = section.require("matrix", "joint space = matrix * axis space");
  if (!value) return;
  const std::size_t size = coupling.axes.size();
  const std::vector<yaml::Value> rows = value->list();
  if (rows.size() != size) {
    value->problem("must have a row for each joint: " + std::to_string(size) + ", not " +
                   std::to_string(rows.size()));
    return;
  }
  for (const yaml::Value& row : rows) {
    if (const auto numbers = row.numbers(size)) coupling.matrix.push_back(*numbers);
  }
  if (coupling.matrix.size() == size && determinant(coupling.matrix) < 1e-12) {
    value->problem("has no inverse: some joint motion would need no axis, or all of them");
  }
}

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
    bool moves_joint = axis.joint == joint;
    for (const CouplingConfig& coupling : robot.couplings) {
      const bool of_coupling =
          std::find(coupling.axes.begin(), coupling.axes.end(), axis.name) != coupling.axes.end();
      const bool has_joint =
          std::find(coupling.joints.begin(), coupling.joints.end(), joint) != coupling.joints.end();
      moves_joint = moves_joint || (of_coupling && has_joint);
    }
    if (moves_joint && !streamsPositions(axis)) incapable.push_back(axis.name);
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

bool isAxisName(const RobotConfig& robot, const std::string& name) {
  return std::any_of(robot.axes.begin(), robot.axes.end(),
                     [&](const drive::AxisConfig& axis) { return axis.name == name; });
}

}  // namespace

void readCouplings(const yaml::Value& value, RobotConfig& robot) {
  std::vector<std::string> axis_names;
  for (const drive::AxisConfig& axis : robot.axes) axis_names.push_back(axis.name);
  std::set<std::string> coupled, joints;
  for (const yaml::Value& entry : value.list()) {
    CouplingConfig coupling;
    yaml::Section section(entry);
    coupling.axes = readNames(section, "axes", axis_names, "axis");
    coupling.joints = readNames(section, "joints", {}, "joint");
    if (coupling.joints.size() != coupling.axes.size()) {
      section.problem("needs as many joints as axes");
    } else {
      readMatrix(section, coupling);
    }
    section.finish();
    for (const std::string& axis : coupling.axes) {
      if (!coupled.insert(axis).second) section.problem("`" + axis + "` is coupled twice");
    }
    for (const std::string& joint : coupling.joints) {
      if (!joints.insert(joint).second) section.problem("joint `" + joint + "` is given twice");
    }
    robot.couplings.push_back(coupling);
  }
  if (!robot.couplings.empty()) {
    value.problem(
        "joints that several axes move together are not supported yet: trajectories would go to "
        "the axes as if each were a joint; leave `couplings` out and command the axes");
  }
  for (const drive::AxisConfig& axis : robot.axes) {
    if (coupled.count(axis.name) == 0 && joints.count(axis.joint) != 0) {
      value.problem("the joint `" + axis.joint + "` is that of an axis without coupling already");
    }
  }
}

std::vector<std::string> jointNames(const RobotConfig& robot) {
  std::vector<std::string> names;
  const auto coupled = [&](const std::string& axis) {
    return std::any_of(
        robot.couplings.begin(), robot.couplings.end(), [&](const CouplingConfig& coupling) {
          return std::find(coupling.axes.begin(), coupling.axes.end(), axis) != coupling.axes.end();
        });
  };
  for (const drive::AxisConfig& axis : robot.axes) {
    if (!coupled(axis.name)) names.push_back(axis.joint);
  }
  for (const CouplingConfig& coupling : robot.couplings) {
    names.insert(names.end(), coupling.joints.begin(), coupling.joints.end());
  }
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
