// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

#include "system/families_motion.h"

namespace cia402 {

/// A joint that is given several commands without a pause, and where it comes to rest.
struct Stations : FamilyScene {
  static constexpr double kNearlyStill = 0.05;  // rad/s
  static constexpr double kOneStep = 1e-4;      // rad, more than a count: 6.3 / (50 * 4000)

  explicit Stations(const std::string& yaml) : FamilyScene(yaml) {}
  void give(std::initializer_list<double> values) {
    for (const double value : values) EXPECT_EQ(setpoint("joint", value), "");
  }
  /// Places where it came to rest, in hundredths of a rad: where it was slowest.
  std::vector<int> visit(Duration time) {
    std::vector<int> rests;
    double slowest = 1.0;
    watch([&] {
      const double speed = std::fabs(velocity("joint"));
      if (speed < kNearlyStill && slowest >= kNearlyStill) rests.push_back(0);
      if (speed < kNearlyStill && speed < slowest) {
        rests.back() = static_cast<int>(std::lround(position("joint") * 100.0));
      }
      slowest = speed < kNearlyStill ? std::min(speed, slowest) : 1.0;
    });
    run(time);
    watch({});
    return rests;
  }
  bool bit(unsigned number) { return ((truth("joint").statusword >> number) & 1u) != 0; }
};

// What a mode of distances is to do, whatever its drive.

inline void expectDistancesAreGone(const std::string& yaml) {
  using namespace std::chrono_literals;
  Stations scene(yaml);
  for (const double distance : {0.3, -0.5, 0.1}) {
    const double from = scene.position("joint");
    scene.give({distance});
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), from + distance, 2 * Stations::kOneStep) << scene.told();
  }
  EXPECT_NEAR(scene.state("joint").position, scene.position("joint"), Stations::kOneStep);
}

inline void expectDistancesAddUp(const std::string& yaml) {
  using namespace std::chrono_literals;
  Stations scene(yaml);
  scene.give({0.2, 0.2, -0.1, 0.3});
  scene.run(8s);
  EXPECT_NEAR(scene.position("joint"), 0.6, 4 * Stations::kOneStep) << scene.told();
}

inline void expectDistancesCountFromAStop(const std::string& yaml) {
  using namespace std::chrono_literals;
  using drive::ProcedureKind;
  Stations scene(yaml);
  scene.give({1.2});
  scene.run(900ms);
  scene.mustSucceed(ProcedureKind::halt);
  scene.mustSucceed(ProcedureKind::enable);
  const double held = scene.position("joint");
  scene.expectStands(500ms);
  scene.give({-0.25});
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), held - 0.25, 2 * Stations::kOneStep) << scene.told();
  scene.mustSucceed(ProcedureKind::disable);
  scene.mustSucceed(ProcedureKind::enable);
  scene.give({0.1});
  scene.run(2s);
  EXPECT_NEAR(scene.position("joint"), held - 0.15, 3 * Stations::kOneStep) << scene.told();
}

/// @param yaml of a joint that stands at 2.2 rad, below its limit of 2.5
inline void expectDistancesEndAtTheLimit(const std::string& yaml) {
  using namespace std::chrono_literals;
  Stations scene(yaml);
  scene.give({0.9});
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 2.5, 2 * Stations::kOneStep) << scene.told();
  scene.give({-0.4});
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 2.1, 3 * Stations::kOneStep) << "from the limit";
}

}  // namespace cia402
