// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/link_findings.h"

#include <algorithm>
#include <utility>

#include "common/text.h"

namespace cia402::bus {
namespace {

/// The axes of each profile that says where its drives read a bit, with that profile.
std::vector<can::SamplePoints> samplePoints(const config::RobotConfig& robot, unsigned bitrate) {
  std::vector<std::pair<std::string, can::SamplePoints>> found;
  for (const drive::AxisConfig& axis : robot.axes) {
    const auto& rates = robot.deviceOf(axis).profile->bus_settings.sample_points;
    const auto points = rates.find(bitrate);
    if (points == rates.end()) continue;
    const std::string& name = axis.profile->name;
    auto known = std::find_if(found.begin(), found.end(),
                              [&](const auto& profile) { return profile.first == name; });
    if (known == found.end()) {
      known = found.insert(found.end(), {name, can::SamplePoints{"", points->second}});
    }
    append(known->second.who, axis.name, ", ");
  }
  std::vector<can::SamplePoints> devices;
  for (auto& [name, points] : found) {
    points.who += " (" + name + ")";
    devices.push_back(points);
  }
  return devices;
}

}  // namespace

std::vector<can::LinkFinding> linkFindings(const can::LinkSettings& link,
                                           const config::RobotConfig& robot, bool may_restart) {
  const auto bitrate = static_cast<unsigned>(robot.bus.bitrate);
  auto findings = can::findingsOf(link, bitrate, robot.bus.sync_period, may_restart);
  if (link.bitrate && *link.bitrate != bitrate) return findings;  // to be set anew anyway
  for (const can::SamplePoints& devices : samplePoints(robot, bitrate)) {
    const auto finding = can::samplePointFinding(link, bitrate, devices);
    if (finding) findings.push_back(*finding);
  }
  return findings;
}

}  // namespace cia402::bus
