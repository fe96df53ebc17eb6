// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "common/text.h"
#include "config/profile/parts.h"
#include "config/robot_parts.h"

namespace cia402::config {

motion::JointLimits readLimits(const yaml::Value& value, drive::AxisGeometry::Type type) {
  motion::JointLimits limits;
  yaml::Section section(value);
  section.read("lower", limits.lower);
  section.read("upper", limits.upper);
  section.read("velocity", limits.velocity, yaml::kPositive);
  section.read("acceleration", limits.acceleration, yaml::kPositive);
  section.read("jerk", limits.jerk, yaml::kPositive);
  section.read("effort", limits.effort, yaml::kPositive);
  section.finish();
  const auto upper = section.get("upper");
  if (limits.lower && limits.upper && !(*limits.lower < *limits.upper)) {
    upper->problem("must be greater than lower (" + section.get("lower")->node().Scalar() +
                   "), not `" + upper->node().Scalar() + "`");
  }
  if (type == drive::AxisGeometry::Type::continuous && (limits.lower || limits.upper)) {
    section.problem("a continuous joint has neither lower nor upper; write `type: revolute`");
  }
  return limits;
}

namespace {

/// By its number, or in the words of the profile.
std::optional<int> homingMethod(const yaml::Value& value, const drive::DriveProfile& profile) {
  const bool words = value.isScalar() && !yaml::parseInteger(value.node().Scalar());
  if (!words) {
    const auto number = value.integer(-128, 127);
    return number ? std::optional<int>(static_cast<int>(*number)) : std::nullopt;
  }
  std::string known;
  for (const auto& [number, method] : profile.homing.methods) {
    if (!number) continue;
    if (method.text == value.node().Scalar()) return number;
    append(known, std::to_string(*number) + " (" + method.text + ")", ", ");
  }
  value.problem("is the number of a homing method, or its words; profile " + profile.name +
                " has " + (known.empty() ? "none" : known) + ", and no `" + value.node().Scalar() +
                "`");
  return {};
}

}  // namespace

drive::HomingOptions readHoming(const yaml::Value& value, const drive::DriveProfile* profile) {
  drive::HomingOptions homing;
  yaml::Section section(value);
  if (const auto method = section.get("method")) {
    if (profile != nullptr) homing.method = homingMethod(*method, *profile);
  }
  section.read("search_velocity", homing.search_velocity, yaml::kPositive);
  section.read("zero_velocity", homing.zero_velocity, yaml::kPositive);
  section.read("acceleration", homing.acceleration, yaml::kPositive);
  section.read("offset", homing.offset);
  if (const auto means = section.get("offset_means")) {
    homing.offset_shifts_zero = means->oneOf({"position_at_home", "shift_of_zero"}) == 1U;
  }
  double timeout = toSeconds(homing.timeout);
  section.read("timeout", timeout, yaml::Range{0.0, 3600.0, true});
  homing.timeout = fromSeconds(timeout);
  section.read("required", homing.required);
  section.read("kept_by_drive", homing.kept_by_drive);
  section.readInteger("order", homing.order, -1000, 1000);
  section.finish();
  return homing;
}

void readIdentity(const yaml::Value& value, canopen::DeviceConfig& device) {
  yaml::Section section(value);
  section.readInteger("vendor_id", device.vendor_id, 0, 0xFFFFFFFF);
  section.readInteger("product_code", device.product_code, 0, 0xFFFFFFFF);
  section.readInteger("revision", device.revision, 0, 0xFFFFFFFF);
  section.readInteger("serial", device.serial, 0, 0xFFFFFFFF);
  section.finish();
}

void readParameters(const yaml::Value& value, drive::AxisConfig& axis) {
  yaml::Section section(value);
  readSubindices(section, "save", axis.save);
  readSubindices(section, "restore", axis.restore);
  section.finish();
}

SimulationConfig readSimulation(const yaml::Value& value) {
  SimulationConfig simulation;
  yaml::Section section(value);
  section.read("drive", simulation.drive);
  if (const auto with = section.get("with")) simulation.with = with->node();
  section.read("initial_position", simulation.initial_position);
  section.read("lower_limit_switch", simulation.lower_limit_switch);
  section.read("upper_limit_switch", simulation.upper_limit_switch);
  section.read("lower_stop", simulation.lower_stop);
  section.read("upper_stop", simulation.upper_stop);
  if (const auto home = section.get("home_switch")) {
    const auto range = home->numbers(2);
    if (range && !((*range)[0] < (*range)[1])) {
      home->problem("must be a range [from, to], the smaller position first");
    } else if (range) {
      simulation.home_switch = std::make_pair((*range)[0], (*range)[1]);
    }
  }
  section.read("index_offset", simulation.index_offset, yaml::Range{0.0, 1.0, false});
  section.read("time_constant", simulation.time_constant, yaml::kPositive);
  section.read("brake_delay", simulation.brake_delay, yaml::kNotNegative);
  section.read("unconfigured", simulation.unconfigured);
  constexpr std::int64_t kHighest = 0xFFFFFFFF;
  section.readInteger("vendor", simulation.vendor, 0, kHighest);
  section.readInteger("product", simulation.product, 0, kHighest);
  section.readInteger("revision", simulation.revision, 0, kHighest);
  section.readInteger("serial", simulation.serial, 0, kHighest);
  section.finish();
  if (simulation.lower_limit_switch && simulation.upper_limit_switch &&
      !(*simulation.lower_limit_switch < *simulation.upper_limit_switch)) {
    section.problem("lower_limit_switch must be less than upper_limit_switch");
  }
  if (simulation.lower_stop && simulation.upper_stop &&
      !(*simulation.lower_stop < *simulation.upper_stop)) {
    section.problem("lower_stop must be less than upper_stop");
  }
  return simulation;
}

}  // namespace cia402::config
