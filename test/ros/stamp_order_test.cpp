// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/stamp_order.h"

#include <gtest/gtest.h>

namespace cia402::ros_node {
namespace {

/// Of a clock that shows 1000 s.
struct Stamps : testing::Test {
  bool next(double stamp, double now = 1000.0) {
    return order.next(ros::Time(stamp), ros::Time(now));
  }
  StampOrder order;
};

TEST_F(Stamps, GoUpOnly) {
  EXPECT_TRUE(next(999.0));
  EXPECT_FALSE(next(999.0)) << "the same feedback once more";
  EXPECT_FALSE(next(998.9));
  EXPECT_TRUE(next(999.000001));
  EXPECT_FALSE(next(999.0)) << "what was refused before, as well";
}

TEST_F(Stamps, ArePassedOverWhereTheClockWasSetBackALittle) {
  EXPECT_TRUE(next(999.9));
  EXPECT_FALSE(next(999.0, 999.1));
  EXPECT_FALSE(next(998.9, 998.9)) << "by a second, not by more";
  EXPECT_TRUE(next(999.95, 1000.0));
}

TEST_F(Stamps, BeginAnewWhereTheClockWasSetBackByMoreThanASecond) {
  EXPECT_TRUE(next(999.9));
  EXPECT_TRUE(next(500.0, 500.1));
  EXPECT_FALSE(next(500.0, 500.1));
  EXPECT_TRUE(next(500.02, 500.1));
}

TEST_F(Stamps, OfAClockThatHasNotBegunAreNone) {
  EXPECT_FALSE(next(0.0, 0.0)) << "as /use_sim_time has it before the first /clock";
}

}  // namespace
}  // namespace cia402::ros_node
