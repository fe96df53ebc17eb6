// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <iterator>

#include "cia402_driver/drive/profile_eds.h"
#include "robot_parts.h"

namespace cia402::config {
namespace {

std::string fileOf(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

}  // namespace

std::shared_ptr<const drive::AxisEds> ProfileCache::eds(const drive::YamlValue& name,
                                                        canopen::NodeId node_id,
                                                        RobotConfig& robot) {
  const auto text = name.text();
  if (!text) return nullptr;
  const std::string path = lookup_(*text);
  std::ifstream file(path, std::ios::binary);
  if (path.empty() || !file) {
    name.problem("there is no file `" + *text +
                 "`; give a path, or the name of a file beside the drive profiles");
    return nullptr;
  }
  const std::string content((std::istreambuf_iterator<char>(file)), {});
  canopen::Eds read = canopen::readEds(content, node_id);
  if (eds_told_.insert(path).second) {
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
    return nullptr;
  }
  return std::make_shared<const drive::AxisEds>(
      drive::AxisEds{fileOf(path), std::move(read.info), std::move(read.dictionary)});
}

void readEds(drive::YamlSection& section, drive::AxisConfig& axis, ProfileCache& cache,
             RobotConfig& robot) {
  const auto value = section.get("eds");
  if (!value) return;
  axis.eds = cache.eds(*value, axis.node_id, robot);
  if (axis.eds == nullptr || axis.profile == nullptr) return;
  axis.profile =
      std::make_shared<const drive::DriveProfile>(drive::withEds(*axis.profile, *axis.eds));
}

void checkEds(drive::YamlSection& section, const drive::AxisConfig& axis, RobotConfig& robot) {
  if (axis.eds == nullptr || axis.profile == nullptr) return;
  const auto found = drive::compareWithEds(*axis.profile, axis.pdos, *axis.eds);
  for (const std::string& problem : found.problems) section.get("eds")->problem(problem);
  for (const std::string& warning : found.warnings) {
    robot.warnings.push_back(section.value().path() + "/eds: " + warning);
  }
}

}  // namespace cia402::config
