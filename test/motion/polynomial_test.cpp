// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/motion/polynomial.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace cia402::motion
