// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

#include "system/families_motion.h"
#include "system/interface_scene.h"

namespace cia402 {

/// A robot of one joint, whose driver's thread can be held up.
class LateJoint : public testing::Test {
 protected:
  explicit LateJoint(const FamilyMode& tested) : tested_(tested) {}

  /// Boots, and sends the joint off to 1 rad.
  void begin() {
    using namespace std::chrono_literals;
    scene.emplace(loadText(familyJoint(tested_)), sim::BusInterface::Options());
    ASSERT_TRUE(scene->runUntil([&] { return scene->allReady(); }, 20s)) << scene->told();
    ASSERT_TRUE(scene->procedure(drive::ProcedureKind::enable).success) << scene->told();
    ASSERT_TRUE(scene->move({1.0}, 2s).success) << scene->told();
    scene->run(1s);
    ASSERT_GT(speed(), 0.5);
  }
  double speed() { return scene->truth(0).velocity_turns * kPerTurn; }
  double place() { return scene->truth(0).position_turns * kPerTurn; }
  /// Runs on, and says how fast it went back at most.
  double backwards(Duration duration) {
    double back = 0.0;
    for (const Time end = scene->now() + duration; scene->now() < end;) {
      scene->run(std::chrono::microseconds(500));
      back = std::max(back, -speed());
    }
    return back;
  }
  /// It was given up, and can be commanded anew.
  void expectGivenUp() {
    using namespace std::chrono_literals;
    EXPECT_THAT(scene->told(), testing::HasSubstr("cycles were missed while it moved"));
    EXPECT_THAT(scene->told(), testing::HasSubstr("trajectory stopped"));
    EXPECT_THAT(scene->told(), testing::Not(testing::HasSubstr("goal reached")));
    ASSERT_TRUE(scene->move({0.2}, 2s).success) << scene->told();
    scene->run(3s);
    EXPECT_NEAR(place(), 0.2, 1e-4) << "it can be commanded anew";
  }
  /// A delay of a joint that has come to its goal moves nothing.
  void expectStandsThroughADelay() {
    using namespace std::chrono_literals;
    scene->run(3s);
    scene->forgetTold();
    const double before = place();
    scene->stall(200ms);
    scene->run(1s);
    EXPECT_NEAR(place(), before, 1e-6);
    EXPECT_THAT(scene->told(),
                testing::Not(testing::HasSubstr("cycles were missed while it moved")));
  }
  std::optional<InterfaceScene> scene;

 private:
  static constexpr double kPerTurn = 6.283185307179586 / 50.0;  // rad of the joint
  FamilyMode tested_;
};

}  // namespace cia402
