// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace cia402::motion {

/// A polynomial of degree 5 or less: c[0] + c[1] x + ... + c[5] x^5.
struct Polynomial {
  static constexpr std::size_t kDegree = 5;
  std::array<double, kDegree + 1> c{};

  /// By Horner's rule; here, as trajectories ask for each joint in each cycle.
  double operator()(double x) const {
    double sum = c[kDegree];
    for (std::size_t k = kDegree; k-- > 0;) sum = sum * x + c[k];
    return sum;
  }
  Polynomial derivative() const;
};

/// Bounds of a polynomial over [0, 1]: never too narrow, often too wide.
struct Bounds {
  double min = 0, max = 0;
};

/// The convex hull of the Bernstein coefficients, which holds the polynomial: many times cheaper
/// than its exact extrema. Does not allocate.
Bounds boundsInUnitInterval(const Polynomial& polynomial);

/// Places in [0, 1], in rising order. A polynomial that is zero everywhere has none.
struct Roots {
  std::array<double, Polynomial::kDegree> x{};
  std::size_t count = 0;
};

/// Every place in [0, 1] where the polynomial is zero or changes its sign, to the last few bits. A
/// zero that is only touched (a double root) may be missed by rounding; nothing hinges on those
/// where the roots of a derivative are asked for extrema. Does not allocate.
Roots rootsInUnitInterval(const Polynomial& polynomial);

}  // namespace cia402::motion
