// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/joint.h"

#include <algorithm>
#include <limits>

#include "common/text.h"

namespace cia402::motion {

const char* toString(JointUnit unit) { return unit == JointUnit::metre ? "m" : "rad"; }

double withinReach(const JointLimits& limits, double wanted, double from) {
  if (limits.lower) wanted = std::max(wanted, std::min(*limits.lower, from));
  if (limits.upper) wanted = std::min(wanted, std::max(*limits.upper, from));
  return wanted;
}

double room(const JointLimits& limits, double position, double velocity) {
  const bool up = velocity > 0.0;
  const std::optional<double>& limit = up ? limits.upper : limits.lower;
  if (!limit) return std::numeric_limits<double>::infinity();
  return up ? *limit - position : position - *limit;
}

std::string formatNumber(double value) { return numberText(value, 8); }

std::string lengthText(double value, JointUnit unit) {
  return formatNumber(value) + " " + toString(unit);
}

}  // namespace cia402::motion
