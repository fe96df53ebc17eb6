// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <iterator>

#include "config/profile/parts.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

std::string fileOf(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

}  // namespace

SharedEds EdsFiles::get(const yaml::Value& name, canopen::NodeId node_id, RobotConfig& robot) {
  const auto text = name.text();
  if (!text) return {};
  const std::string path = lookup_(*text);
  std::ifstream file(path, std::ios::binary);
  if (path.empty() || !file) {
    name.problem("there is no file `" + *text +
                 "`; give a path, or the name of a file beside the drive profiles");
    return {};
  }
  const std::string content((std::istreambuf_iterator<char>(file)), {});
  canopen::Eds read = canopen::readEds(content, node_id);
  if (told_.insert(path).second) {
    for (const canopen::EdsProblem& problem : read.problems) {
      robot.warnings.push_back(path + ": " + toString(problem));
    }
    if (read.problems_left_out != 0) {
      robot.warnings.push_back(path + ": and " + std::to_string(read.problems_left_out) +
                               " further problems");
    }
  }
  if (read.dictionary.objects().empty()) {
    name.problem("`" + path + "` describes no object: it is no EDS or DCF, or it is damaged");
    return {};
  }
  return {std::make_shared<const fieldbus::DeviceDescription>(
              fieldbus::DeviceDescription{fileOf(path), std::move(read.dictionary)}),
          std::make_shared<const canopen::EdsInfo>(std::move(read.info))};
}

void readEds(yaml::Section& section, AxisDraft& draft, EdsFiles& files, RobotConfig& robot) {
  drive::AxisConfig& axis = draft.axis;
  const auto value = section.get("eds");
  if (draft.first && value) {
    const SharedEds eds = files.get(*value, draft.device.node_id, robot);
    axis.description = eds.description;
    draft.device.eds = eds.info;
  }
  for (const drive::AxisConfig& other : robot.axes) {
    if (other.device == axis.device) axis.description = other.description;
  }
  if (axis.description == nullptr || axis.profile == nullptr) return;
  axis.profile =
      std::make_shared<const drive::DriveProfile>(withEds(*axis.profile, *axis.description));
}

void checkEds(yaml::Section& section, const AxisDraft& draft, RobotConfig& robot) {
  const drive::AxisConfig& axis = draft.axis;
  if (axis.description == nullptr || axis.profile == nullptr) return;
  const auto found = compareWithEds(*axis.profile, draft.device, draft.pdos(), *axis.description);
  const yaml::Value at = section.get("eds").value_or(section.value());
  for (const std::string& problem : found.problems) at.problem(problem);
  for (const std::string& warning : found.warnings) {
    robot.warnings.push_back(section.value().path() + "/eds: " + warning);
  }
}

}  // namespace cia402::config
