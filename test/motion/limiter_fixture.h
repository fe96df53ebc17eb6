// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <random>

#include "cia402_driver/common/time.h"
#include "motion/joint.h"

namespace cia402::motion::test {

inline Joint elbow() {
  Joint joint;
  joint.name = "elbow";
  joint.limits.lower = -1.5;
  joint.limits.upper = 2.0;
  joint.limits.velocity = 1.0;
  joint.limits.acceleration = 5.0;
  return joint;
}

/// Cycles that are late and early, commands that step, drift, shake, pause and are not numbers.
class Storm {
 public:
  explicit Storm(unsigned seed) : engine_(seed) {}

  double random(double magnitude) {
    return std::uniform_real_distribution<double>(-magnitude, magnitude)(engine_);
  }
  Duration cycle() {
    const double jitter = chance(0.01) ? 8 : 1 + random(0.4);
    return fromSeconds(0.004 * jitter);
  }
  std::optional<double> command(double magnitude) {
    if (chance(0.004)) silent_ = static_cast<int>(50 + random(50));
    if (silent_ > 0 && --silent_ > 0) return std::nullopt;
    if (chance(0.002)) return std::nan("");
    if (chance(0.01)) kind_ = static_cast<int>(2 + random(2));
    if (kind_ == 0) return value_ = random(magnitude);
    if (kind_ == 1) return value_ += random(0.005 * magnitude);
    if (kind_ == 2) return value_ + random(1e-4);
    if (chance(0.02)) value_ = random(magnitude);
    return value_;
  }

 private:
  bool chance(double p) { return std::bernoulli_distribution(p)(engine_); }

  std::mt19937 engine_;
  int silent_ = 0, kind_ = 0;
  double value_ = 0;
};

}  // namespace cia402::motion::test
