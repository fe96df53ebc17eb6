// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/polynomial.h"

#include <algorithm>
#include <cmath>

namespace cia402::motion {

namespace {

/// The only root of a polynomial that is monotone on [a, b] and has opposite signs at its ends:
/// Newton's method, with bisection wherever a step would leave the bracket or gain too little.
double rootBetween(const Polynomial& f, const Polynomial& slope, double a, double b) {
  const bool rising = f(a) < 0;
  double x = 0.5 * (a + b);
  for (int i = 0; i < 100; ++i) {
    const double value = f(x);
    if (value == 0) return x;
    ((value < 0) == rising ? a : b) = x;
    const double newton = x - value / slope(x);
    const bool usable = newton > a && newton < b && i % 4 != 3;
    const double next = usable ? newton : 0.5 * (a + b);
    if (next == x || std::abs(next - x) < 1e-16) return next;
    x = next;
  }
  return x;
}

/// Between two neighbouring roots of its derivative a polynomial is monotone, so that each such
/// interval holds at most one root.
Roots roots(const Polynomial& f, std::size_t degree) {
  while (degree > 0 && f.c[degree] == 0) --degree;
  Roots found;
  if (degree == 0) return found;
  const Polynomial slope = f.derivative();
  const Roots turning = roots(slope, degree - 1);
  const auto add = [&found](double x) {
    const bool is_new = found.count == 0 || found.x[found.count - 1] < x;
    if (is_new && found.count < found.x.size()) found.x[found.count++] = x;
  };
  double left = 0;
  for (std::size_t i = 0; i <= turning.count; ++i) {
    const double right = i < turning.count ? turning.x[i] : 1.0;
    const double at_left = f(left), at_right = f(right);
    if (at_left == 0) add(left);
    if ((at_left < 0 && at_right > 0) || (at_left > 0 && at_right < 0)) {
      add(rootBetween(f, slope, left, right));
    }
    if (at_right == 0) add(right);
    left = right;
  }
  return found;
}

}  // namespace

Polynomial Polynomial::derivative() const {
  Polynomial result;
  for (std::size_t k = 0; k < kDegree; ++k) result.c[k] = static_cast<double>(k + 1) * c[k + 1];
  return result;
}

Bounds boundsInUnitInterval(const Polynomial& polynomial) {
  constexpr std::size_t kCount = Polynomial::kDegree + 1;
  // kWeights[i][k] = C(i, k) / C(5, k): the i-th Bernstein coefficient's share of c[k].
  constexpr double kWeights[kCount][kCount] = {{1, 0, 0, 0, 0, 0},
                                               {1, 1 / 5.0, 0, 0, 0, 0},
                                               {1, 2 / 5.0, 1 / 10.0, 0, 0, 0},
                                               {1, 3 / 5.0, 3 / 10.0, 1 / 10.0, 0, 0},
                                               {1, 4 / 5.0, 6 / 10.0, 4 / 10.0, 1 / 5.0, 0},
                                               {1, 1, 1, 1, 1, 1}};
  Bounds bounds{polynomial.c[0], polynomial.c[0]};
  for (std::size_t i = 1; i < kCount; ++i) {
    double coefficient = 0;
    for (std::size_t k = 0; k <= i; ++k) coefficient += kWeights[i][k] * polynomial.c[k];
    bounds.min = std::min(bounds.min, coefficient);
    bounds.max = std::max(bounds.max, coefficient);
  }
  return bounds;
}

Roots rootsInUnitInterval(const Polynomial& polynomial) {
  return roots(polynomial, Polynomial::kDegree);
}

}  // namespace cia402::motion
