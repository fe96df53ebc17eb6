// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/clock_map.h"

#include <gtest/gtest.h>

namespace cia402::ros_node {
namespace {

using namespace std::chrono_literals;

/// A simulated bus whose process may lose hours.
struct ClockMap : testing::Test {
  ClockMap() {
    ros::Time::init();
    time.advance(kNever);
  }
  void stall(Duration duration) {
    clock += duration;
    time.advance(kNever);
  }
  Time clock = bus::realNow() - 24h;
  bus::BusTime time{bus::BusTime::Kind::simulated, [this] { return clock; }};
};

TEST_F(ClockMap, StampsLieNearNowHoweverMuchWasLost) {
  stall(24h);
  EXPECT_EQ(time.lost(), 24h);
  EXPECT_NEAR(toRos(time, time.now() + 1us).toSec(), ros::Time::now().toSec(), 60.0);
}

TEST_F(ClockMap, AStampDoesNotChangeWhenMoreIsLost) {
  const Time moment = time.now();
  const ros::Time stamp = toRos(time, moment);
  stall(12h);
  EXPECT_NEAR((toRos(time, moment) - stamp).toSec(), 0.0, 0.01);
  EXPECT_GT(toRos(time, time.now() + 1ms) - stamp, ros::Duration(12 * 3600 - 60));
}

TEST_F(ClockMap, AStampIsTheMomentItWasMadeOf) {
  stall(12h);
  const Time moment = time.now() + 5s;
  EXPECT_LT(std::abs(toSeconds(fromRos(time, toRos(time, moment)) - moment)), 0.01);
}

}  // namespace
}  // namespace cia402::ros_node
