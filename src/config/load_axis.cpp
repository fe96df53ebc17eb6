// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "cia402_driver/drive/profile_reader.h"
#include "robot_parts.h"

namespace cia402::config {
namespace {

using drive::AxisConfig;
using drive::AxisGeometry;
using drive::kPositive;
using drive::YamlSection;
using drive::YamlValue;

void readNodeId(YamlSection& section, AxisConfig& axis, const RobotConfig& robot) {
  const auto value = section.require("node_id", "the drive's CANopen node-ID, 1 to 127");
  const auto id = value ? value->integer(1, 127) : std::nullopt;
  if (!id) return;
  axis.node_id = static_cast<canopen::NodeId>(*id);
  if (axis.node_id == robot.bus.node_id) {
    value->problem(std::to_string(*id) + " is the master's own node-ID (bus/node_id)");
  }
  for (const AxisConfig& other : robot.axes) {
    if (other.node_id != axis.node_id) continue;
    value->problem(std::to_string(*id) + " is the node-ID of `" + other.name + "` already");
    break;
  }
}

void readJoint(YamlSection& section, AxisConfig& axis, const RobotConfig& robot) {
  axis.joint = axis.name;
  section.read("joint", axis.joint);
  for (const AxisConfig& other : robot.axes) {
    if (other.joint != axis.joint) continue;
    section.problem("the joint `" + axis.joint + "` is that of `" + other.name + "` already");
    break;
  }
}

void readGeometry(YamlSection& section, AxisGeometry& geometry) {
  if (const auto type = section.get("type")) {
    const auto index = type->oneOf({"revolute", "prismatic", "continuous"});
    if (index) geometry.type = static_cast<AxisGeometry::Type>(*index);
  }
  section.read("counts_per_turn", geometry.counts_per_turn, kPositive);
  section.read("gear_ratio", geometry.gear_ratio, kPositive);
  section.read("lead", geometry.lead, kPositive);
  section.read("position_offset", geometry.position_offset);
  section.read("rated_torque", geometry.rated_torque, kPositive);
  const auto direction = section.get("direction");
  const auto sign = direction ? direction->integer(-1, 1) : std::nullopt;
  if (sign == 0) direction->problem("must be 1 or -1, not `0`");
  if (sign && *sign != 0) geometry.direction = static_cast<int>(*sign);
}

void readSections(YamlSection& section, AxisConfig& axis, RobotConfig& robot) {
  if (const auto limits = section.get("limits")) {
    axis.limits = readLimits(*limits, axis.geometry.type);
  }
  if (const auto homing = section.get("homing")) axis.homing = readHoming(*homing);
  if (const auto identity = section.get("identity")) readIdentity(*identity, axis);
  if (const auto lss = section.get("lss")) readLss(*lss, axis, robot);
  if (const auto parameters = section.get("parameters")) readParameters(*parameters, axis);
  readNodeOptions(section, axis);
  if (const auto frame = section.get("frame")) {
    robot.frames.push_back(readFrame(*frame, axis.joint));
  }
  SimulationConfig simulation;
  if (const auto value = section.get("simulation")) simulation = readSimulation(*value);
  if (simulation.drive.empty() && axis.profile) simulation.drive = axis.profile->name;
  robot.simulated[axis.name] = simulation;
}

// The keys whose meaning depends on the profile.
void readWithProfile(YamlSection& section, AxisConfig& axis) {
  const auto writes = section.get("write");
  if (!axis.profile) return;
  if (writes) axis.writes = drive::readWrites(*writes, *axis.profile, drive::WriteList::boot);
}

}  // namespace

bool isGraphName(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto allowed = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && letter(name[0]) && std::all_of(name.begin(), name.end(), allowed);
}

std::shared_ptr<const drive::DriveProfile> ProfileCache::get(const YamlValue& name) {
  const auto text = name.text();
  if (!text) return nullptr;
  const std::string path = lookup_(*text);
  if (path.empty()) {
    name.problem("there is no drive profile `" + *text +
                 "`; give the name of a file in config/drives without .yaml, or a path");
    return nullptr;
  }
  const auto known = profiles_.find(path);
  if (known != profiles_.end()) return known->second;
  Problems of_profile;
  const drive::DriveProfile profile = drive::loadDriveProfile(path, of_profile);
  for (const Problem& problem : of_profile.list()) problems_.add(problem.path, problem.message);
  auto& entry = profiles_[path];
  if (of_profile.empty()) entry = std::make_shared<const drive::DriveProfile>(profile);
  return entry;
}

void readAxis(const std::string& name, const YamlValue& value, ProfileCache& profiles,
              RobotConfig& robot) {
  AxisConfig axis;
  axis.name = name;
  axis.sync_period = robot.bus.sync_period;
  YamlSection section(value);
  if (!isGraphName(name)) {
    section.problem("an axis is named by a letter, then letters, digits and _");
  }
  readNodeId(section, axis, robot);
  readJoint(section, axis, robot);
  const auto drive_name = section.require("drive", "the drive's profile, e.g. generic_cia402");
  if (drive_name) axis.profile = profiles.get(*drive_name);
  readEds(section, axis, profiles, robot);
  readGeometry(section, axis.geometry);
  if (axis.geometry.type == AxisGeometry::Type::prismatic) axis.standstill_velocity = 0.002;
  section.read("mode", axis.mode);
  axis.mode = drive::canonicalModeName(axis.mode);
  double timeout = toSeconds(axis.command_timeout);
  section.read("command_timeout", timeout, drive::Range{0.0, 60.0, true});
  axis.command_timeout = fromSeconds(timeout);
  if (const auto action = section.get("command_timeout_action")) {
    axis.brake_after_effort = action->oneOf({"brake", "coast"}).value_or(0) == 0;
  }
  if (const auto end = section.get("quick_stop")) {
    axis.quick_stop_holds = end->oneOf({"disable", "hold"}).value_or(0) == 1;
  }
  readSections(section, axis, robot);
  readWithProfile(section, axis);
  if (axis.profile && axis.mode.empty()) {
    const bool streams = axis.profile->mode("cyclic_position") != nullptr;
    axis.mode = streams ? "cyclic_position" : axis.profile->modes.front().name;
  }
  if (choosePdos(section, axis, robot)) checkAxis(section, axis, robot);
  checkEds(section, axis, robot);
  checkErrorControl(section, axis, robot);
  section.finish();
  robot.axes.push_back(axis);
}

}  // namespace cia402::config
