// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/robot_drives.h"

#include <algorithm>
#include <utility>

#include "sim/definition/drive_definition.h"
#include "sim/device/context.h"

namespace cia402::sim {
namespace {

constexpr double kTwoPi = 6.283185307179586476925;

/// Turns of the shaft on which the drive counts, 0 where the drive says 0. Written here and not
/// shared with the driver, for a mistake in a sign would cancel out.
double shaftTurns(const drive::AxisConfig& axis, double joint) {
  const drive::AxisGeometry& geometry = axis.geometry;
  const double per_joint_turn = axis.profile->output_shaft ? 1.0 : geometry.gear_ratio;
  const double turn =
      geometry.type == drive::AxisGeometry::Type::prismatic ? geometry.lead : kTwoPi;
  return (joint - geometry.position_offset) / turn * per_joint_turn * geometry.direction;
}

AxisMechanics mechanicsOf(const drive::AxisConfig& axis, const config::SimulationConfig& section) {
  AxisMechanics mechanics;
  mechanics.initial_position = shaftTurns(axis, section.initial_position);
  if (axis.geometry.counts_per_turn > 0.0) {
    mechanics.counts_per_turn = axis.geometry.counts_per_turn;
  }
  // A reversed axis meets its lower joint limit at the drive's positive switch.
  const bool reversed = axis.geometry.direction < 0;
  const auto& lower = reversed ? section.upper_limit_switch : section.lower_limit_switch;
  const auto& upper = reversed ? section.lower_limit_switch : section.upper_limit_switch;
  if (lower) mechanics.negative_limit_switch = shaftTurns(axis, *lower);
  if (upper) mechanics.positive_limit_switch = shaftTurns(axis, *upper);
  if (section.home_switch) {
    const double a = shaftTurns(axis, section.home_switch->first);
    const double b = shaftTurns(axis, section.home_switch->second);
    mechanics.home_switch_low = std::min(a, b);
    mechanics.home_switch_high = std::max(a, b);
  }
  if (section.index_offset) mechanics.index_offset = *section.index_offset;
  if (section.time_constant) mechanics.inertia_time_constant = *section.time_constant;
  mechanics.brake_delay = section.brake_delay;
  return mechanics;
}

}  // namespace

std::vector<SimulatedAxis> simulatedAxes(const config::RobotConfig& robot,
                                         const std::string& folder, Problems& problems) {
  std::vector<SimulatedAxis> axes;
  for (const drive::AxisConfig& axis : robot.axes) {
    const auto section = robot.simulated.find(axis.name);
    const config::SimulationConfig simulation =
        section == robot.simulated.end() ? config::SimulationConfig() : section->second;
    const std::string name = simulation.drive.empty() ? axis.profile->name : simulation.drive;
    const bool is_path = name.find('/') != std::string::npos;
    auto definition =
        loadDriveDefinition(is_path ? name : folder + "/" + name + ".yaml", simulation.with);
    if (!definition) {
      problems.add("axes/" + axis.name + "/simulation/drive", definition.error().message);
      continue;
    }
    const canopen::NodeId node =
        simulation.unconfigured ? kUnconfigured : robot.deviceOf(axis).node_id;
    const DriveIdentity identity{simulation.vendor, simulation.product, simulation.revision,
                                 simulation.serial};
    axes.push_back({axis.name, node, *definition, mechanicsOf(axis, simulation), identity});
  }
  return axes;
}

}  // namespace cia402::sim
