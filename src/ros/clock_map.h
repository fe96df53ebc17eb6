// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/time.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "bus/bus_time.h"

namespace cia402::ros_node {

/// Nanoseconds that ROS time is ahead of CLOCK_MONOTONIC. The same value as long as the clocks keep
/// their distance to 0.5 ms, so that one moment always has one stamp and stamps keep their order;
/// two readings of the clocks alone would differ by as long as the thread was interrupted between.
inline std::int64_t clockDistance() {
  static std::atomic<std::int64_t> distance{0};
  constexpr std::int64_t kTolerance = 500'000;
  std::int64_t best = 0, width = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < 3; ++i) {
    const std::int64_t before = bus::realNow().time_since_epoch().count();
    const auto ros_now = static_cast<std::int64_t>(ros::Time::now().toNSec());
    const std::int64_t after = bus::realNow().time_since_epoch().count();
    if (after - before >= width) continue;
    width = after - before;
    best = ros_now - (before + width / 2);
  }
  const std::int64_t kept = distance.load();
  if (std::abs(best - kept) <= kTolerance + width / 2) return kept;
  distance = best;
  return best;
}

/// ROS time of a moment on the bus.
inline ros::Time toRos(const bus::BusTime& time, Time moment) {
  const std::int64_t stamp = time.toClock(moment).time_since_epoch().count() + clockDistance();
  return stamp <= 0 ? ros::Time() : ros::Time().fromNSec(static_cast<std::uint64_t>(stamp));
}

/// The moment on the bus of a ROS time.
inline Time fromRos(const bus::BusTime& time, const ros::Time& moment) {
  const auto stamp = static_cast<std::int64_t>(moment.toNSec());
  return time.fromClock(Time(Duration(stamp - clockDistance())));
}

}  // namespace cia402::ros_node
