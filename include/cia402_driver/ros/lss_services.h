// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <vector>

#include "cia402_driver/bus/runner.h"

namespace cia402::ros_node {

/// The services of LSS: `~lss_scan`, `~lss_assign`, `~lss_set_bit_timing`. A call returns when the
/// task has ended and keeps a thread of the node handle's callback queue until then.
class LssServices {
 public:
  LssServices(ros::NodeHandle& private_node, bus::BusRunner& runner);

 private:
  bus::BusRunner& runner_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace cia402::ros_node
