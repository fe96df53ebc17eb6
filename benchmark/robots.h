// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bus/command.h"
#include "config/robot.h"
#include "sim/world/robot_drives.h"

namespace cia402::benchmark {

/// A configured robot and its simulated drives.
struct TestRobot {
  config::RobotConfig robot;
  canopen::MasterConfig master;
  std::vector<sim::SimulatedDrive> drives;
};

/// Which PDOs a drive has.
enum class Layout {
  profile,  ///< those of the profile generic_cia402
  lean,     ///< one RPDO (controlword, target position), one TPDO (statusword, position, mode)
};

/// `axes` generic drives in cyclic synchronous position mode at 1 Mbit/s, all in the group "all".
/// @throws std::runtime_error with every problem of the configuration.
TestRobot genericRobot(int axes, double sync_period_s, Layout layout);

/// A trajectory for "all" in which every joint swings as a sine of its own frequency for
/// `duration_s`, and then comes to rest.
/// @param period_s between points, which carry position, velocity and acceleration.
bus::TrajectoryCommand swing(const config::RobotConfig& robot, double duration_s, double period_s);
/// Where that trajectory has joint number `joint` after `time_s`, at most its duration.
double swingPosition(std::size_t joint, double time_s);

}  // namespace cia402::benchmark
