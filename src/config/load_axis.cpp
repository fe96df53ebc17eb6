// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/text.h"
#include "config/drive_family.h"
#include "config/profile/parts.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

using drive::AxisConfig;
using drive::AxisGeometry;

void readJoint(yaml::Section& section, AxisConfig& axis, const RobotConfig& robot) {
  axis.joint = axis.name;
  section.read("joint", axis.joint);
  for (const AxisConfig& other : robot.axes) {
    if (other.joint != axis.joint) continue;
    section.problem("the joint `" + axis.joint + "` is that of `" + other.name + "` already");
    break;
  }
}

void readGeometry(yaml::Section& section, AxisGeometry& geometry) {
  if (const auto type = section.get("type")) {
    const auto index = type->oneOf({"revolute", "prismatic", "continuous"});
    if (index) geometry.type = static_cast<AxisGeometry::Type>(*index);
  }
  section.read("counts_per_turn", geometry.counts_per_turn, yaml::kPositive);
  section.read("gear_ratio", geometry.gear_ratio, yaml::kPositive);
  section.read("lead", geometry.lead, yaml::kPositive);
  section.read("position_offset", geometry.position_offset);
  section.read("rated_torque", geometry.rated_torque, yaml::kPositive);
  const auto direction = section.get("direction");
  const auto sign = direction ? direction->integer(-1, 1) : std::nullopt;
  if (sign == 0) direction->problem("must be 1 or -1, not `0`");
  if (sign && *sign != 0) geometry.direction = static_cast<int>(*sign);
}

void readDevice(yaml::Section& section, canopen::DeviceConfig& device, const RobotConfig& robot) {
  if (const auto identity = section.get("identity")) readIdentity(*identity, device);
  if (const auto lss = section.get("lss")) readLss(*lss, device, robot);
  readNodeOptions(section, device);
}

void readDrive(yaml::Section& section, AxisDraft& draft, ProfileCache& profiles) {
  const auto name = section.require("drive", "the drive's profile, e.g. generic_cia402");
  if (!name) return;
  const SharedFamily family = profiles.get(*name);
  if (draft.first) draft.device.profile = family.device;
  if (draft.device.profile) draft.axis.profile = family.drive;  // else its first axis has a mistake
  if (draft.axis.device_axis == 0 || !draft.axis.profile) return;
  draft.axis.profile = std::make_shared<const drive::DriveProfile>(
      drive::ofDeviceAxis(*family.drive, draft.axis.device_axis));
}

/// Puts what was read into the robot.
void keep(const AxisDraft& draft, RobotConfig& robot) {
  robot.axes.push_back(draft.axis);
  if (draft.first) {
    robot.devices.push_back(draft.device);
    return;
  }
  canopen::DeviceConfig& device = robot.devices[draft.axis.device];
  device = draft.device;
  std::string joints;
  for (const AxisConfig& axis : robot.axes) {
    if (axis.device == draft.axis.device) joints += (joints.empty() ? "" : ", ") + axis.joint;
  }
  device.title = joints + " (node " + std::to_string(device.node_id) + ")";
}

void readAxisLimits(yaml::Section& section, AxisConfig& axis, const AxisReading& reading,
                    RobotConfig& robot) {
  if (const auto limits = section.get("limits")) {
    axis.limits = readLimits(*limits, axis.geometry.type);
  }
  if (reading.coupled.count(axis.name) != 0) return;
  const yaml::Value& value = section.value();
  axis.limits = reading.described.strictest({drive::jointOf(axis), value.path() + "/limits"},
                                            value.problems(), robot);
  axis.limits.continuous = false;
}

void readSections(yaml::Section& section, AxisDraft& draft, RobotConfig& robot) {
  AxisConfig& axis = draft.axis;
  if (const auto homing = section.get("homing"))
    axis.homing = readHoming(*homing, axis.profile.get());
  if (draft.first) readDevice(section, draft.device, robot);
  if (const auto parameters = section.get("parameters")) readParameters(*parameters, axis);
  if (const auto frame = section.get("frame")) readFrame(*frame, axis.joint, robot);
  SimulationConfig simulation;
  if (const auto value = section.get("simulation")) simulation = readSimulation(*value);
  if (simulation.drive.empty() && axis.profile) simulation.drive = axis.profile->name;
  robot.simulated[axis.name] = simulation;
}

/// Settings of the drive that may be written where they are not as the profile's checks want them.
void readAdjust(const yaml::Value& list, AxisConfig& axis) {
  std::vector<std::string> known;
  for (const drive::SettingCheck& check : axis.profile->checks) {
    if (check.write == drive::SettingCheck::Write::asked) known.push_back(check.objects.front());
  }
  if (axis.profile->counts_rule.adjustable) known.emplace_back("counts_rule");
  for (const yaml::Value& entry : list.list()) {
    if (const auto index = entry.oneOf(known)) axis.adjust.push_back(known[*index]);
  }
}

/// Settings that a check of the profile wants to be given, and that the drive has already.
void readKeeps(const yaml::Value& list, AxisConfig& axis) {
  std::vector<std::string> known;
  for (const drive::SettingCheck& check : axis.profile->checks) {
    if (check.condition.kind != drive::Condition::Kind::given) continue;
    known.insert(known.end(), check.objects.begin(), check.objects.end());
  }
  for (const yaml::Value& entry : list.list()) {
    if (const auto index = entry.oneOf(known)) axis.keeps.push_back(known[*index]);
  }
}

/// The units that count while a setting of the drive holds the number that the axis names; it is
/// compared with that before each enabling.
void useUnitSystem(const yaml::Value& value, drive::DriveProfile& profile) {
  const drive::UnitSystems& systems = profile.unit_systems;
  if (systems.object.empty()) {
    value.problem("profile " + profile.name + " knows units of one system only");
    return;
  }
  const auto number = value.integer(0, 0xFFFF);
  const auto check = std::find_if(profile.checks.begin(), profile.checks.end(), [&](const auto& c) {
    return !c.objects.empty() && c.objects.front() == systems.object;
  });
  if (!number || check->condition.holds(*number)) return;  // that of `units`
  const auto units = systems.others.find(*number);
  if (units == systems.others.end()) {
    std::string known;
    for (const auto& entry : systems.others) append(known, std::to_string(entry.first), ", ");
    value.problem("profile " + profile.name + " knows no units for " + systems.object + " = " +
                  std::to_string(*number) + ", but for " + known);
    return;
  }
  profile.units = units->second;
  check->condition.numbers = {*number};
  check->texts.clear();
  check->text = "the axis reckons in other units than the drive";
  check->remedy = "write " + std::to_string(*number) + " to " + systems.object +
                  ", or give the axis the `unit_system` that it holds";
}

/// What is otherwise here than the profile says: inputs and outputs that are wired besides its own,
/// the side of the gear that the drive counts at, its units.
void readWiring(yaml::Section& section, AxisConfig& axis) {
  const auto inputs = section.get("inputs"), outputs = section.get("outputs");
  const auto shaft = section.get("output_shaft"), units = section.get("unit_system");
  if (!axis.profile || (!inputs && !outputs && !shaft && !units)) return;
  const auto own = std::make_shared<drive::DriveProfile>(*axis.profile);
  section.read("output_shaft", own->output_shaft);
  if (inputs) readDigitalInputs(*inputs, *own);
  if (outputs) readDigitalOutputs(*outputs, *own);
  if (units) useUnitSystem(*units, *own);
  axis.profile = own;
}

// The keys whose meaning depends on the profile.
void readWithProfile(yaml::Section& section, AxisConfig& axis) {
  const auto writes = section.get("write");
  const auto adjust = section.get("adjust");
  const auto trusted = section.get("trusted");
  const auto keeps = section.get("keeps");
  readWiring(section, axis);
  const auto way = section.get("disable_by");
  if (!axis.profile) return;
  axis.disabling = way ? readDisabling(*way) : axis.profile->disabling;
  if (keeps) readKeeps(*keeps, axis);
  if (adjust) readAdjust(*adjust, axis);
  if (trusted) readTrusted(*trusted, axis);
  if (writes) axis.writes = readWrites(*writes, *axis.profile, WriteList::boot);
}

}  // namespace

bool isGraphName(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto allowed = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && letter(name[0]) && std::all_of(name.begin(), name.end(), allowed);
}

SharedFamily ProfileCache::get(const yaml::Value& name) {
  const auto text = name.text();
  if (!text) return {};
  const std::string path = lookup_(*text);
  if (path.empty()) {
    name.problem("there is no drive profile `" + *text +
                 "`; give the name of a file in config/drives without .yaml, or a path");
    return {};
  }
  const auto known = profiles_.find(path);
  if (known != profiles_.end()) return known->second;
  Problems of_profile;
  const DriveFamily family = loadDriveFamily(path, of_profile);
  for (const Problem& problem : of_profile.list()) problems_.add(problem.path, problem.message);
  SharedFamily& entry = profiles_[path];
  if (of_profile.empty()) {
    entry = {std::make_shared<const drive::DriveProfile>(family.drive),
             std::make_shared<const canopen::DeviceProfile>(family.device)};
  }
  return entry;
}

void readAxis(const std::string& name, const yaml::Value& value, AxisReading& reading,
              RobotConfig& robot) {
  AxisDraft draft;
  AxisConfig& axis = draft.axis;
  axis.name = draft.device.name = name;
  axis.cycle = robot.bus.sync_period;
  yaml::Section section(value);
  if (!isGraphName(name)) {
    section.problem("an axis is named by a letter, then letters, digits and _");
  } else if (name == "bus") {
    section.problem(
        "`bus` is what diagnostics and inject_fault call the whole: choose another name");
  }
  readPlace(section, draft, robot);
  checkDeviceKeys(section, draft, reading);
  readJoint(section, axis, robot);
  if (draft.first) draft.device.title = drive::whoIs(axis);
  readDrive(section, draft, reading.profiles);
  if (draft.first) readHalfFloatKey(section, draft);
  readEds(section, draft, reading.eds, robot);
  readGeometry(section, axis.geometry);
  if (axis.geometry.prismatic()) axis.standstill_velocity = 0.002;
  section.read("mode", axis.mode);
  axis.mode = drive::canonicalModeName(axis.mode);
  double timeout = toSeconds(axis.command_timeout);
  section.read("command_timeout", timeout, yaml::Range{0.0, 60.0, true});
  axis.command_timeout = fromSeconds(timeout);
  if (const auto action = section.get("command_timeout_action")) {
    axis.brake_after_effort = action->oneOf({"brake", "coast"}).value_or(0) == 0;
  }
  section.read("unwatched_streams", axis.unwatched_streams);
  readFeedForward(section, axis);
  if (const auto end = section.get("quick_stop")) {
    axis.quick_stop_holds = end->oneOf({"disable", "hold"}).value_or(0) == 1;
  }
  if (const auto moving = section.get("set_mode_in_motion")) {
    axis.set_mode_stops = moving->oneOf({"refuse", "stop"}).value_or(0) == 1;
  }
  readAxisLimits(section, axis, reading, robot);
  readSections(section, draft, robot);
  readWithProfile(section, axis);
  if (axis.profile && axis.mode.empty()) {
    const bool streams = axis.profile->mode("cyclic_position") != nullptr;
    axis.mode = streams ? "cyclic_position" : axis.profile->modes.front().name;
  }
  const unsigned axes = reading.axes_of[draft.device.node_id];
  if (choosePdos(section, draft, robot, axes)) {
    checkAxis(section, draft, robot);
    checkDoubts(section, draft, robot);
  }
  tunePositionLoop(section, axis);
  tuneSetPointStream(section, axis);
  checkFeedForward(section, axis);
  checkEds(section, draft, robot);
  if (draft.first) checkErrorControl(section, draft, robot);
  section.finish();
  keep(draft, robot);
}

}  // namespace cia402::config
