// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/joint.h"

#include <gtest/gtest.h>

#include <limits>

namespace cia402::motion {
namespace {

TEST(WithinReach, BetweenTheLimitsAndFromOutsideOnlyBack) {
  JointLimits limits;
  limits.lower = -1.5;
  limits.upper = 2.0;
  struct Case {
    double wanted, from, reached;
  };
  const Case cases[] = {
      {0.5, 0.0, 0.5},    {2.0, 0.0, 2.0},    {2.1, 0.0, 2.0},  {-1.5, 0.0, -1.5},
      {-1.6, 0.0, -1.5},                                                            // from inside
      {3.0, 2.5, 2.5},    {2.2, 2.5, 2.2},    {1.0, 2.5, 1.0},  {-9.0, 2.5, -1.5},  // from above
      {-3.0, -2.5, -2.5}, {-2.2, -2.5, -2.2}, {1.0, -2.5, 1.0}, {9.0, -2.5, 2.0},   // from below
  };
  for (const Case& test : cases) {
    EXPECT_EQ(withinReach(limits, test.wanted, test.from), test.reached)
        << test.wanted << " from " << test.from;
  }
}

TEST(Room, IsTheWayToTheLimitThatIsMovedTo) {
  JointLimits limits;
  limits.lower = -1.5;
  EXPECT_EQ(room(limits, 1.0, -0.1), 2.5);
  EXPECT_EQ(room(limits, 1.0, 0.0), 2.5);
  EXPECT_EQ(room(limits, -2.0, -0.1), -0.5) << "beyond it";
  EXPECT_EQ(room(limits, 1.0, 0.1), std::numeric_limits<double>::infinity());
  limits.upper = 2.0;
  EXPECT_EQ(room(limits, 1.0, 0.1), 1.0);
  EXPECT_EQ(room(limits, 2.5, 0.1), -0.5);
  EXPECT_EQ(room(limits, 2.5, -0.1), 4.0) << "on the way back";
}

TEST(WithinReach, ASideWithoutLimitIsOpen) {
  JointLimits limits;
  EXPECT_EQ(withinReach(limits, 100.0, 0.0), 100.0);
  EXPECT_EQ(withinReach(limits, -100.0, 0.0), -100.0);
  limits.lower = -1.5;
  EXPECT_EQ(withinReach(limits, 100.0, 0.0), 100.0);
  EXPECT_EQ(withinReach(limits, -100.0, 0.0), -1.5);
  limits.lower.reset();
  limits.upper = 2.0;
  EXPECT_EQ(withinReach(limits, 100.0, 0.0), 2.0);
  EXPECT_EQ(withinReach(limits, -100.0, 0.0), -100.0);
}

TEST(JointText, NamesUnitsAndShortensNumbers) {
  EXPECT_STREQ(toString(JointUnit::radian), "rad");
  EXPECT_STREQ(toString(JointUnit::metre), "m");
  EXPECT_EQ(formatNumber(3.1), "3.1");
  EXPECT_EQ(formatNumber(-0.25), "-0.25");
  EXPECT_EQ(formatNumber(1.0 / 3.0), "0.33333333");
}

}  // namespace
}  // namespace cia402::motion
