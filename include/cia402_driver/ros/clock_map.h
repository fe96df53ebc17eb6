// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/time.h>

#include "cia402_driver/bus/real_clock.h"

namespace cia402::ros_node {

/// ROS time of a moment on the bus, by the present distance of the two clocks.
inline ros::Time toRos(Time time) {
  const ros::Time now = ros::Time::now();
  return now - ros::Duration().fromNSec((bus::realNow() - time).count());
}

/// The moment on the bus of a ROS time.
inline Time fromRos(const ros::Time& time) {
  const ros::Time now = ros::Time::now();
  return bus::realNow() + Duration((time - now).toNSec());
}

}  // namespace cia402::ros_node
