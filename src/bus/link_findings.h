// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "can/link_settings.h"
#include "config/robot.h"

namespace cia402::bus {

/// What is wrong with the settings of an interface for this robot, its drives' sample points among
/// them. @param may_restart see can::findingsOf()
std::vector<can::LinkFinding> linkFindings(const can::LinkSettings& link,
                                           const config::RobotConfig& robot, bool may_restart);

}  // namespace cia402::bus
