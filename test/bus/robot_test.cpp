// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using test::kPeriod;
using test::RobotWorld;
using testing::HasSubstr;
using namespace std::chrono_literals;

TEST(Robot, SendsNothingBeforeItIsStarted) {
  RobotWorld world;
  world.run(1s);
  EXPECT_TRUE(world.sent.empty());
  EXPECT_EQ(world.robot.nextDeadline(), kNever);
}

TEST(Robot, BootsAndEnablesItsDrives) {
  RobotWorld world;
  world.enable();
  EXPECT_TRUE(world.drives[0].enabled());
  EXPECT_TRUE(world.drives[1].enabled());
  EXPECT_EQ(world.eventsWith("shoulder (node 1): identified, configured and started"), 1u);
}

}  // namespace
}  // namespace cia402::bus
