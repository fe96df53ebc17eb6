// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/ready_robot.h"

namespace cia402::config {

std::optional<ReadyRobot> readyRobot(const YAML::Node& tree, const ProfileLookup& profiles,
                                     Problems& problems) {
  ReadyRobot ready;
  ready.robot = loadRobot(tree, profiles, problems);
  if (!problems.empty()) return std::nullopt;
  ready.master = makeMasterConfig(ready.robot, problems);
  if (!problems.empty()) return std::nullopt;
  return ready;
}

}  // namespace cia402::config
