// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <limits>
#include <string>
#include <vector>

#include "motion/trajectory.h"

namespace cia402::motion {

/// Two joints without limits, at rest at 0, and a trajectory that starts at 100 s.
class TrajectoryFixture : public testing::Test {
 protected:
  static constexpr Time kNow{std::chrono::seconds(100)};
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

  static Time at(double seconds) { return kNow + fromSeconds(seconds); }
  static TrajectoryPoint point(double seconds, std::vector<double> positions,
                               std::vector<double> velocities = {},
                               std::vector<double> accelerations = {}) {
    return {std::move(positions), std::move(velocities), std::move(accelerations),
            fromSeconds(seconds)};
  }

  TrajectoryResult create(const std::vector<TrajectoryPoint>& points) const {
    return Trajectory::create(joints, commanded, points, start);
  }
  /// Checks that the trajectory is refused with this code and a sentence holding this part.
  void expectRefused(const std::vector<TrajectoryPoint>& points, TrajectoryErrorCode code,
                     const std::string& part) const {
    const TrajectoryResult result = create(points);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, code);
    EXPECT_THAT(result.error().message, testing::HasSubstr(part));
  }
  void expectInvalid(const std::vector<TrajectoryPoint>& points, const std::string& part) const {
    expectRefused(points, TrajectoryErrorCode::invalid_goal, part);
  }

  std::vector<Joint> joints{{"shoulder", {}, JointUnit::radian}, {"lift", {}, JointUnit::metre}};
  std::vector<MotionState> commanded{{}, {}};
  TrajectoryStart start{kNow, std::nullopt, false};
};

}  // namespace cia402::motion
