// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/sync_timing.h"

#include <cmath>

namespace cia402::sim {

double interpolationPeriod(const DriveValues& values) {
  const double exponent = static_cast<double>(values.raw(Role::interpolation_exponent, -3));
  return static_cast<double>(values.raw(Role::interpolation_time, 0)) * std::pow(10.0, exponent);
}

double syncTolerance(const DriveDefinition& definition, const DriveValues& values,
                     const ModeDefinition* mode) {
  const bool watched = mode != nullptr && mode->behaviour == ModeBehaviour::interpolated_position;
  if (!watched) return kUnlimited;
  const auto& shares = definition.sync_tolerances;
  const std::int64_t number = values.raw(Role::sync_tolerance, 0);
  if (number < 0 || number >= static_cast<std::int64_t>(shares.size())) return kUnlimited;
  const double share = shares[static_cast<std::size_t>(number)];
  return share > 0.0 ? share * interpolationPeriod(values) : kUnlimited;
}

}  // namespace cia402::sim
