// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>

#include <array>
#include <string>

#include "common/problems.h"
#include "ros/diff_drive_base.h"

namespace cia402::ros_node {

/// The private parameters of diff_drive_node (docs/diff_drive.md).
struct DiffDriveParameters {
  DiffDriveOptions base;
  double rate = 50.0;                 ///< Hz, of commands
  std::string group = "/bus/wheels";  ///< of the driver, that the wheels are
  std::string odom_frame = "odom", base_frame = "base_link";
  bool publish_tf = true;
  /// x, y, z, roll, pitch, yaw, in m^2 and rad^2; of a twist per s^2. What is not measured has 1e6.
  std::array<double, 6> pose_covariance{{0.001, 0.001, 1e6, 1e6, 1e6, 0.03}};
  std::array<double, 6> twist_covariance{{0.001, 0.001, 1e6, 1e6, 1e6, 0.03}};
};

DiffDriveParameters readDiffDrive(const ros::NodeHandle& private_node, Problems& problems);

}  // namespace cia402::ros_node
