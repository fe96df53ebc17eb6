// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <functional>
#include <string>

#include "bus/reply.h"
#include "sim/world/robot_drives.h"

namespace cia402::ros_node {

/// The service ~inject_fault of simulated drives.
class FaultService {
 public:
  using Inject = std::function<bus::Answer(const std::string& axis, const std::string& fault)>;
  FaultService(ros::NodeHandle& private_node, Inject inject);

 private:
  Inject inject_;
  ros::ServiceServer server_;
};

/// Injects into an axis of a drive (nullptr: there is none of that name) and words the answer.
bus::Answer injectFault(sim::AxisOfDrive found, const std::string& axis, const std::string& fault,
                        Time now);

}  // namespace cia402::ros_node
