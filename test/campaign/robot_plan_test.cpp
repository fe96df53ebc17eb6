// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/robot_plan.h"

#include <gtest/gtest.h>

#include "campaign/stage.h"
#include "folders.h"

namespace cia402::campaign {
namespace {

bool hasNeighbours(const RobotPlan& plan) {
  for (const AxisPlan& axis : plan.axes) {
    if (axis.neighbour) return true;
  }
  return false;
}

RobotPlan planOf(unsigned seed) {
  Random random(seed);
  return planRobot(random);
}

// One in six of 600: 100, standard deviation 9.
TEST(RobotPlan, HasDrivesOfTwoAxesNowAndThen) {
  int with = 0;
  for (unsigned seed = 1; seed <= 600; ++seed) with += hasNeighbours(planOf(seed)) ? 1 : 0;
  EXPECT_GT(with, 64);
  EXPECT_LT(with, 136);
}

TEST(RobotPlan, PutsNeighboursIntoOneDrive) {
  int found = 0, two_pairs = 0, shared_pdos = 0;
  bool first_last = false;
  for (unsigned seed = 1; found < 25; ++seed) {
    const RobotPlan plan = planOf(seed);
    if (!hasNeighbours(plan)) continue;
    SCOPED_TRACE(seed);
    ++found;
    const auto loaded = loadRobot(plan.yaml, cia402::test::configFolder());
    ASSERT_TRUE(loaded) << loaded.error().message << "\n" << plan.yaml;
    std::size_t together = 0;
    for (std::size_t i = 0; i < plan.axes.size(); ++i) {
      if (!plan.axes[i].neighbour) continue;
      ++together;
      const drive::AxisConfig& axis = loaded->robot.axes[i];
      const drive::AxisConfig& other = loaded->robot.axes[*plan.axes[i].neighbour];
      EXPECT_EQ(plan.axes[i].family->profile, std::string("generic_cia402"));
      if (loaded->robot.deviceOf(axis).profile->pdos_per_axis == 0) ++shared_pdos;
      EXPECT_EQ(plan.axes[*plan.axes[i].neighbour].neighbour, i);
      EXPECT_EQ(axis.device, other.device);
      EXPECT_EQ(axis.device_axis + other.device_axis, 1U);
      first_last = first_last || (axis.device_axis == 1 && *plan.axes[i].neighbour > i);
    }
    EXPECT_EQ(loaded->robot.devices.size(), plan.axes.size() - together / 2);
    if (together == 4) ++two_pairs;
  }
  EXPECT_GT(two_pairs, 0);
  EXPECT_GT(shared_pdos, 0);
  EXPECT_TRUE(first_last) << "whichever axis is written first";
}

}  // namespace
}  // namespace cia402::campaign
