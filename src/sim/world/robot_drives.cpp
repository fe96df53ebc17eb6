// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/robot_drives.h"

#include <algorithm>
#include <map>
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
  const double turn = geometry.prismatic() ? geometry.lead : kTwoPi;
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
  const auto& lower_stop = reversed ? section.upper_stop : section.lower_stop;
  const auto& upper_stop = reversed ? section.lower_stop : section.upper_stop;
  if (lower_stop) mechanics.negative_stop = shaftTurns(axis, *lower_stop);
  if (upper_stop) mechanics.positive_stop = shaftTurns(axis, *upper_stop);
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

/// The drive that an axis sits in is described by the first axis that the configuration has of it.
class Builder {
 public:
  Builder(const config::RobotConfig& robot, std::string folder, Problems& problems)
      : robot_(robot), folder_(std::move(folder)), problems_(problems) {}

  void add(const drive::AxisConfig& axis) {
    const config::SimulationConfig simulation = sectionOf(axis);
    const auto known = drive_of_.find(axis.device);
    if (known == drive_of_.end()) {
      begin(axis, simulation);
    } else if (known->second) {
      compare(axis, simulation, drives_[*known->second]);
    }
    if (const auto drive = drive_of_[axis.device]) put(axis, simulation, drives_[*drive]);
  }
  std::vector<SimulatedDrive> take() { return std::move(drives_); }

 private:
  using Definition = Result<std::shared_ptr<const DriveDefinition>>;

  config::SimulationConfig sectionOf(const drive::AxisConfig& axis) const {
    const auto section = robot_.simulated.find(axis.name);
    return section == robot_.simulated.end() ? config::SimulationConfig() : section->second;
  }

  void begin(const drive::AxisConfig& axis, const config::SimulationConfig& simulation) {
    drive_of_[axis.device] = std::nullopt;
    auto definition = definitionOf(axis, simulation);
    if (!definition) return tell(axis, "drive", definition.error().message);
    SimulatedDrive drive;
    drive.name = axis.name;
    drive.node = simulation.unconfigured ? kUnconfigured : robot_.deviceOf(axis).node_id;
    drive.definition = *definition;
    drive.identity = {simulation.vendor, simulation.product, simulation.revision,
                      simulation.serial};
    drive.mechanics.resize((*definition)->axisCount());
    drive_of_[axis.device] = drives_.size();
    drives_.push_back(std::move(drive));
  }

  /// Drives of one file share it, but for those that count other keys.
  Definition definitionOf(const drive::AxisConfig& axis,
                          const config::SimulationConfig& simulation) {
    const std::string name = simulation.drive.empty() ? axis.profile->name : simulation.drive;
    const bool is_path = name.find('/') != std::string::npos;
    const std::string file = is_path ? name : folder_ + "/" + name + ".yaml";
    if (simulation.with.size() > 0) return loadDriveDefinition(file, simulation.with);
    const auto known = definitions_.find(file);
    if (known != definitions_.end()) return known->second;
    return definitions_.emplace(file, loadDriveDefinition(file, simulation.with)).first->second;
  }

  /// A further axis may say nothing else of the drive.
  void compare(const drive::AxisConfig& axis, const config::SimulationConfig& simulation,
               const SimulatedDrive& drive) {
    const config::SimulationConfig first = sectionOf(*axisNamed(drive.name));
    const bool other_drive =
        simulation.drive != first.drive && simulation.drive != axis.profile->name;
    const bool has_with = simulation.with.IsDefined() && !simulation.with.IsNull();
    const bool other_with = has_with && YAML::Dump(simulation.with) != YAML::Dump(first.with);
    const bool other_state = simulation.unconfigured && !first.unconfigured;
    const bool identified =
        simulation.vendor || simulation.product || simulation.revision || simulation.serial;
    if (!other_drive && !other_with && !other_state && !identified) return;
    tell(axis, "drive",
         "is of the drive that `" + drive.name +
             "` sits in, too: `drive`, `with`, `unconfigured` and its identity are "
             "told there (a further axis' `drive` and `with` may repeat them)");
  }

  void put(const drive::AxisConfig& axis, const config::SimulationConfig& simulation,
           SimulatedDrive& drive) {
    if (axis.device_axis >= drive.mechanics.size()) {
      return tell(axis, "drive",
                  "the simulated drive has " + std::to_string(drive.mechanics.size()) +
                      (drive.mechanics.size() == 1 ? " axis" : " axes") +
                      ", and this is its axis " + std::to_string(axis.device_axis) +
                      "; take one with more (`axes` of its definition)");
    }
    drive.mechanics[axis.device_axis] = mechanicsOf(axis, simulation);
    drive.axes.emplace_back(axis.name, axis.device_axis);
  }

  const drive::AxisConfig* axisNamed(const std::string& name) const {
    const auto found =
        std::find_if(robot_.axes.begin(), robot_.axes.end(),
                     [&](const drive::AxisConfig& axis) { return axis.name == name; });
    return &*found;
  }

  void tell(const drive::AxisConfig& axis, const char* key, const std::string& what) {
    problems_.add("axes/" + axis.name + "/simulation/" + key, what);
  }

  const config::RobotConfig& robot_;
  std::string folder_;
  Problems& problems_;
  std::vector<SimulatedDrive> drives_;
  std::map<std::string, Definition> definitions_;  ///< by their files
  std::map<std::size_t, std::optional<std::size_t>>
      drive_of_;  ///< device; nothing: it has problems
};

}  // namespace

std::optional<AxisPlace> findAxis(const std::vector<SimulatedDrive>& drives,
                                  const std::string& axis) {
  for (std::size_t i = 0; i < drives.size(); ++i) {
    for (const auto& [name, number] : drives[i].axes) {
      if (name == axis) return AxisPlace{i, number};
    }
  }
  return {};
}

void addTo(World& world, const std::vector<SimulatedDrive>& drives) {
  for (const SimulatedDrive& drive : drives) {
    world.addDrive(drive.name, drive.definition, drive.node, drive.mechanics[0], drive.identity,
                   drive.further());
  }
}

std::vector<SimulatedDrive> simulatedDrives(const config::RobotConfig& robot,
                                            const std::string& folder, Problems& problems) {
  Builder builder(robot, folder, problems);
  for (const drive::AxisConfig& axis : robot.axes) builder.add(axis);
  return builder.take();
}

}  // namespace cia402::sim
