// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/trajectory_order.h"

#include <utility>

namespace cia402::bus {

void TrajectoryOrder::tell(const TrajectoryOutcome& outcome) {
  id = 0;
  if (const TrajectoryEnded once = std::exchange(ended, nullptr)) once(outcome);
}

std::vector<motion::TrajectoryPoint> reorder(const std::vector<motion::TrajectoryPoint>& points,
                                             const std::vector<std::size_t>& places) {
  const auto pick = [&places](const std::vector<double>& values) {
    if (values.size() != places.size()) return values;  // absent, or an error that create() words
    std::vector<double> picked;
    for (std::size_t from : places) picked.push_back(values[from]);
    return picked;
  };
  std::vector<motion::TrajectoryPoint> ordered;
  for (const motion::TrajectoryPoint& point : points) {
    ordered.push_back({pick(point.positions), pick(point.velocities), pick(point.accelerations),
                       point.time_from_start});
  }
  return ordered;
}

}  // namespace cia402::bus
