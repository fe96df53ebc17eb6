// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/stop_ramp.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cia402::motion {
namespace {

using std::chrono::milliseconds;

TEST(StopRamp, StopsWithConstantDeceleration) {
  StopRamp stop;
  stop.begin(1.0, -2.0, 4.0);
  for (int i = 0; i < 250; ++i) stop.advance(milliseconds(1));
  EXPECT_NEAR(stop.velocity(), -1.0, 1e-9);
  EXPECT_FALSE(stop.finished());
  for (int i = 0; i < 250; ++i) stop.advance(milliseconds(1));
  EXPECT_TRUE(stop.finished());
  EXPECT_NEAR(stop.position(), 1.0 - 0.5, 1e-9);  // v^2 / 2a
  stop.advance(milliseconds(100));
  EXPECT_NEAR(stop.position(), 0.5, 1e-9);
}

TEST(StopRamp, AtRestItIsFinishedAtOnce) {
  StopRamp stop;
  stop.begin(0.3, 0.0, 1.0);
  EXPECT_TRUE(stop.finished());
  EXPECT_EQ(stop.position(), 0.3);
}

TEST(StopRamp, AVelocityThatIsNoNumberIsNone) {
  for (const double velocity : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    StopRamp stop;
    stop.begin(0.3, velocity, 1.0);
    EXPECT_TRUE(stop.finished());
    EXPECT_EQ(stop.velocity(), 0.0);
  }
}

TEST(StopRamp, GoesNowhereWhereNoTimeHasPassed) {
  StopRamp stop;
  stop.begin(0.3, 1.0, 2.0);
  for (const Duration none : {Duration(0), -Duration(milliseconds(10))}) {
    stop.advance(none);
    EXPECT_EQ(stop.position(), 0.3);
    EXPECT_EQ(stop.velocity(), 1.0);
  }
}

TEST(StopRamp, IsFinishedHoweverTheNumbersRound) {
  for (int i = 1; i < 50; ++i) {
    for (int j = 1; j < 50; ++j) {
      StopRamp stop;
      stop.begin(0.0, 0.1 * i, 0.3 * j);
      stop.advance(std::chrono::hours(1));
      EXPECT_TRUE(stop.finished()) << i << ", " << j << ": " << stop.velocity();
    }
  }
}

}  // namespace
}  // namespace cia402::motion
