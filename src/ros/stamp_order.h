// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/duration.h>
#include <ros/time.h>

namespace cia402::ros_node {

/// Keeps the stamps of messages in order, for those who take no second one of a stamp, or warn of
/// it, as listeners of tf do.
class StampOrder {
 public:
  /// May a message with this stamp be sent? It then counts as sent. Its stamp must be later than
  /// that of the last one; but where this lies more than a second ahead of the clock, somebody has
  /// set the clock back, and all stamps begin anew.
  /// @param now ROS time
  [[nodiscard]] bool next(const ros::Time& stamp, const ros::Time& now) {
    const bool set_back = last_ > now + ros::Duration(1.0);
    if (stamp <= last_ && !set_back) return false;
    last_ = stamp;
    return true;
  }

 private:
  ros::Time last_;
};

}  // namespace cia402::ros_node
