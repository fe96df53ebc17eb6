// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A motor that could not follow does not set off by itself when what held it is gone.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;

void begin(Scene& scene) {
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message;
  scene.run(100ms);
}

// The lengths of the stream end it in each phase of being called back.
TEST(HeldMotor, StaysWhereItIsWhenItsLimitSwitchIsReleased) {
  for (const Duration pushed : {300ms, 320ms, 340ms, 360ms, 380ms, 400ms}) {
    Scene scene(loadText(genericPair(", simulation: {upper_limit_switch: 0.1}")));
    begin(scene);
    scene.stream("left", 2.0, pushed);
    scene.run(1s);
    ASSERT_GT(scene.position("left"), 0.09) << "it did not reach the switch";
    scene.drive("left").mechanics().positive_limit_switch = 1e9;
    scene.forget();
    scene.run(1s);
    EXPECT_LT(scene.seen("left").travel(), 1e-3) << toSeconds(pushed);
  }
}

TEST(HeldMotor, StaysWhereItIsWhenItsRotorIsLetGo) {
  for (const Duration pushed : {150ms, 200ms, 250ms, 300ms}) {
    Scene scene(loadText(damiaoJoint()));
    begin(scene);
    scene.inject("joint", "blocked_rotor");
    scene.stream("joint", -1.0, pushed);
    scene.run(1s);
    scene.inject("joint", "clear");
    scene.run(200ms);  // it relaxes to where it was called back
    scene.forget();
    scene.run(2s);
    EXPECT_LT(scene.seen("joint").travel(), 1e-3) << toSeconds(pushed);
  }
}

}  // namespace
}  // namespace cia402
