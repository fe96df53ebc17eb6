// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Stops of velocity mode (vl, CiA 402-2) with a drive whose ramps are locked by bit 5 of the
// controlword also on the way out of operation: the motor is the judge.
#include "system/families_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;

const char kLocked[] = ", simulation: {with: {state_machine: {locked_ramp_holds_stops: true}}}";

class LockedRamp : public testing::TestWithParam<FamilyMode> {
 protected:
  LockedRamp() : scene(loadText(familyJoint(GetParam(), kLocked))) {}
  void turn() {
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
    scene.stream("joint", 0.5, 1s);
    ASSERT_NEAR(scene.velocity("joint"), 0.5, 5e-3);
  }
  void expectRest() {
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
  }

  Scene scene;
};

TEST_P(LockedRamp, IsHeldFreeForAQuickStop) {
  turn();
  const bus::Answer stopped = scene.procedure(ProcedureKind::quick_stop);
  EXPECT_TRUE(stopped.success) << stopped.message;
  expectRest();
}

TEST_P(LockedRamp, IsHeldFreeWhileItIsDisabled) {
  turn();
  const bus::Answer disabled = scene.procedure(ProcedureKind::disable);
  EXPECT_TRUE(disabled.success) << disabled.message;
  expectRest();
}

// Nothing that travels in cycles is heard: the quick stop comes by SDO, with the same bits.
TEST_P(LockedRamp, IsHeldFreeByTheUrgentQuickStop) {
  turn();
  scene.axis("joint").stopBesideCycle("the cable of its cyclic data is cut");
  scene.run(1s);
  expectRest();
}

TEST_P(LockedRamp, IsHeldFreeAtAShutdown) {
  turn();
  scene.robot().network().beginShutdown(scene.now());
  ASSERT_TRUE(scene.runUntil([&] { return scene.robot().network().shutDown(); }, 2s));
  expectRest();
}

INSTANTIATE_TEST_SUITE_P(All, LockedRamp,
                         testing::Values(FamilyMode{"nimotion_stepper", "4000", "vl"},
                                         FamilyMode{"generic_cia402", "131072", "vl"}),
                         [](const auto& tested) { return std::string(tested.param.family); });

}  // namespace
}  // namespace cia402
