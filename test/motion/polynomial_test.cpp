// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/polynomial.h"

#include <gtest/gtest.h>

#include <random>

namespace cia402::motion {
namespace {

TEST(Polynomial, EvaluatesByItsCoefficients) {
  const Polynomial f{{1, 2, 3, 4, 5, 6}};
  EXPECT_EQ(f(1), 21);
  EXPECT_EQ(f(2), 1 + 4 + 12 + 32 + 80 + 192);
}

TEST(Polynomial, DerivativeLowersEachPower) {
  const Polynomial slope = Polynomial{{7, 2, 3, 4, 5, 6}}.derivative();
  EXPECT_EQ(slope.c, (std::array<double, 6>{2, 6, 12, 20, 30, 0}));
}

TEST(Polynomial, FindsAllFiveRootsOfAProductOfLinearFactors) {
  // (x-0.1)(x-0.3)(x-0.5)(x-0.7)(x-0.9), multiplied out by hand
  const Polynomial f{{-0.00945, 0.1689, -0.950, 2.3, -2.5, 1}};
  const Roots roots = rootsInUnitInterval(f);
  ASSERT_EQ(roots.count, 5U);
  const double expected[] = {0.1, 0.3, 0.5, 0.7, 0.9};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(roots.x[i], expected[i], 1e-12);
}

TEST(Polynomial, IgnoresRootsOutsideTheUnitInterval) {
  const Roots roots = rootsInUnitInterval(Polynomial{{-1, 1.5, 1}});  // (x-0.5)(x+2)
  ASSERT_EQ(roots.count, 1U);
  EXPECT_NEAR(roots.x[0], 0.5, 1e-15);
}

TEST(Polynomial, FindsATripleRoot) {
  const Roots roots = rootsInUnitInterval(Polynomial{{-0.125, 0.75, -1.5, 1}});  // (x-0.5)^3
  ASSERT_GE(roots.count, 1U);
  EXPECT_NEAR(roots.x[0], 0.5, 1e-5);
}

TEST(Polynomial, NoRootIsTwiceInTheList) {
  const Roots once = rootsInUnitInterval(Polynomial{{0.25, -1, 1}});  // (x-0.5)^2
  ASSERT_EQ(once.count, 1U);
  EXPECT_EQ(once.x[0], 0.5);
  EXPECT_EQ(rootsInUnitInterval(Polynomial{{0, 0, 1}}).count, 1U);  // x^2
}

TEST(Polynomial, FindsRootsAtBothEnds) {
  const Roots roots = rootsInUnitInterval(Polynomial{{0, -1, 1}});  // x(x-1)
  ASSERT_EQ(roots.count, 2U);
  EXPECT_EQ(roots.x[0], 0);
  EXPECT_EQ(roots.x[1], 1);
}

TEST(Polynomial, ConstantsHaveNoRoots) {
  EXPECT_EQ(rootsInUnitInterval(Polynomial{{3}}).count, 0U);
  EXPECT_EQ(rootsInUnitInterval(Polynomial{}).count, 0U);
}

TEST(Polynomial, BoundsAreTheHullOfItsBernsteinCoefficients) {
  // x - x^2 has the coefficients 0, 1/5, 3/10, 3/10, 1/5, 0 (by hand); its true maximum is 1/4
  const Bounds hill = boundsInUnitInterval(Polynomial{{0, 1, -1}});
  EXPECT_NEAR(hill.min, 0.0, 1e-15);
  EXPECT_NEAR(hill.max, 0.3, 1e-15);
  const Bounds power = boundsInUnitInterval(Polynomial{{0, 0, 0, 0, 0, 2}});  // 2 x^5
  EXPECT_EQ(power.min, 0);
  EXPECT_EQ(power.max, 2);
}

TEST(Polynomial, BoundsHoldEveryValue) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 2000; ++i) {
    Polynomial f;
    for (double& c : f.c) c = static_cast<double>(random() % 2001) * 0.01 - 10.0;
    const Bounds bounds = boundsInUnitInterval(f);
    for (int k = 0; k <= 50; ++k) {
      const double value = f(0.02 * k);
      ASSERT_GE(value, bounds.min - 1e-9) << i;
      ASSERT_LE(value, bounds.max + 1e-9) << i;
    }
  }
}

}  // namespace
}  // namespace cia402::motion
