// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "system/scene.h"

namespace cia402 {

/// A sine of 0.5 rad and 0.25 Hz, which begins gently, of 12 s.
inline double sinePath(double t) {
  const double begun = std::min(1.0, t / 3.0);
  return begun * begun * (3.0 - 2.0 * begun) * 0.5 * std::sin(2.0 * 3.14159265358979 * 0.25 * t);
}

/// Sends the first group, of one joint, along it.
/// @return largest distance of the motor from where the path was two cycles before it was looked
/// at, which is where a motor is that does at once what it is told, rad
inline double worstOffSinePath(Scene& scene, const std::string& joint) {
  bus::TrajectoryCommand trajectory;
  trajectory.group = scene.loaded().robot.groups[0].name;
  trajectory.joints = scene.loaded().robot.groups[0].joints;
  for (int i = 1; i <= 600; ++i) {
    const double t = 0.02 * i;
    trajectory.points.push_back({{sinePath(t)}, {}, {}, fromSeconds(t)});
  }
  const Time begin = scene.now();
  EXPECT_TRUE(scene.call(std::move(trajectory)).success) << scene.told();
  double worst = 0.0;
  scene.watch([&] {
    const double t = toSeconds(scene.now() - begin) - 0.012;
    if (t > 0.1 && t < 11.9) {
      worst = std::max(worst, std::fabs(scene.position(joint) - sinePath(t)));
    }
  });
  scene.run(std::chrono::seconds(13));
  scene.watch({});
  EXPECT_NEAR(scene.position(joint), sinePath(12.0), 2e-4) << scene.told();
  EXPECT_NEAR(scene.velocity(joint), 0.0, 1e-4);
  return worst;
}

}  // namespace cia402
