// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using test::RobotWorld;
using namespace std::chrono_literals;

/// Joints that may be sent farther than their drives count: 32 bits of 0.00001 rad end at 21474.8
/// rad.
config::RobotConfig beyondTheDrive() {
  config::RobotConfig config = test::testRobot();
  for (drive::AxisConfig& axis : config.axes) {
    axis.limits.lower.reset();
    axis.limits.upper.reset();
    axis.limits.velocity = 1e5;
    axis.limits.acceleration = 1e6;
  }
  return config;
}

TEST(GroupRefusal, OfASetPointThatDoesNotFitTheDriveIsToldAsTheReason) {
  RobotWorld world(beyondTheDrive());
  world.enable();
  ASSERT_TRUE(world.move({30000.0, 0.0}, 2.0).success);
  world.run(2s);
  EXPECT_EQ(world.eventsWith("arm: trajectory stopped: shoulder refused a set-point: it does not "
                             "fit the drive"),
            1u)
      << world.allEvents();
  EXPECT_EQ(world.eventsWith("fell out of operation"), 0u);
  EXPECT_FALSE(world.group().executing());
}

// The reason of one trajectory is none of the next.
TEST(GroupRefusal, OfASetPointDoesNotEndTheNextTrajectory) {
  RobotWorld world(beyondTheDrive());
  world.enable();
  ASSERT_TRUE(world.move({21474.0, 0.0}, 2.0).success);
  world.run(3s);
  world.events.clear();
  ASSERT_TRUE(world.move({21480.0, 0.0}, 2.0).success);
  world.run(3s);
  ASSERT_FALSE(world.group().executing() || world.group().stopping());
  ASSERT_TRUE(world.move({21470.0, 1.0}, 2.0).success);
  world.run(3s);
  EXPECT_EQ(world.eventsWith("refused a set-point"), 1u) << world.allEvents();
  EXPECT_EQ(world.eventsWith("arm: goal reached"), 1u) << world.allEvents();
  EXPECT_EQ(world.drives[1].position, 100000);
}

}  // namespace
}  // namespace cia402::bus
