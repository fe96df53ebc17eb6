// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How each family comes to rest in each of its modes, and goes on by a new command alone. What the
// joint does is read from the motor.
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using drive::State;
using testing::HasSubstr;

constexpr double kStopRamp = 4.0;       // limits/acceleration, rad/s^2
constexpr double kStreamTimeout = 0.2;  // command_timeout, s

class FamilyStops : public testing::TestWithParam<FamilyMode> {};

TEST_P(FamilyStops, AHaltHoldsUntilItIsEnabledAndGoesOnByANewCommandAlone) {
  FamilyScene scene(familyJoint(GetParam()));
  for (const double direction : {1.0, downwards(GetParam())}) {
    scene.sendOff(direction);
    scene.mustSucceed(ProcedureKind::halt);
    // A position loop of the driver's takes some tenths of a second for the last tenths of a mrad.
    const bool looped = scene.state("joint").mode->position_loop.has_value();
    EXPECT_NEAR(scene.velocity("joint"), 0.0, looped ? 5e-3 : 1e-3);
    EXPECT_THAT(scene.setpoint("joint", 0.1), HasSubstr("halted; enable releases the halt"));
    scene.expectStands(400ms, looped ? 5e-4 : 1e-4);
    scene.mustSucceed(ProcedureKind::halt);
    scene.expectStands(200ms);
    EXPECT_TRUE(scene.truth("joint").power_stage_on);
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(500ms);
  }
  EXPECT_EQ(scene.state("joint").error_code, 0) << scene.told();
}

TEST_P(FamilyStops, AQuickStopAndADisableEndDisabledAndEnablingMovesNothing) {
  FamilyScene scene(familyJoint(GetParam()));
  double direction = 1.0;
  for (const ProcedureKind kind : {ProcedureKind::quick_stop, ProcedureKind::disable}) {
    scene.sendOff(direction);
    const double speed = std::fabs(scene.velocity("joint")), from = scene.position("joint");
    scene.mustSucceed(kind);
    // By twice the acceleration limit or the limit itself, once the call has reached the drive.
    EXPECT_LT(std::fabs(scene.position("joint") - from),
              0.03 * speed + 1.1 * speed * speed / (2.0 * kStopRamp));
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
    EXPECT_EQ(scene.state("joint").state, State::switch_on_disabled);
    scene.expectStands(300ms);
    EXPECT_THAT(scene.setpoint("joint", 0.1), HasSubstr("joint (node 1)"));
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(500ms);
    direction = downwards(GetParam());
  }
  scene.sendOff();
}

class FamilyStreams : public testing::TestWithParam<FamilyMode> {};

TEST_P(FamilyStreams, ThatEndBringItToRest) {
  FamilyScene scene(familyJoint(GetParam()));
  const drive::ModeSpec& mode = *scene.state("joint").mode;
  double waits = kStreamTimeout;
  if (mode.kind == ControlKind::position) {
    waits = 0.0;
    const double start = scene.position("joint");
    for (int i = 1; i <= 40; ++i) {
      ASSERT_EQ(scene.setpoint("joint", start + 0.5 * 0.02 * i), "");
      scene.run(20ms);
    }
  } else {
    scene.sendOff();
  }
  const double speed = scene.velocity("joint"), from = scene.position("joint");
  ASSERT_GT(speed, 0.3);
  scene.forget();
  scene.run(2s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
  const double fastest = scene.seen("joint").fastest;  // an effort goes on until it is given up
  EXPECT_LT(scene.position("joint") - from,
            fastest * (waits + 0.05) + 1.1 * fastest * fastest / (2.0 * kStopRamp));
  EXPECT_LT(scene.seen("joint").highest - scene.position("joint"), 5e-4) << "nothing turns back";
}

TEST_P(FamilyStops, ADriverThatEndsLeavesItAtRestAndSwitchedOff) {
  FamilyScene scene(familyJoint(GetParam()));
  scene.sendOff();
  const double speed = scene.velocity("joint"), from = scene.position("joint");
  double when_off = 1e9;
  scene.watch([&] {
    if (when_off > 1e8 && !scene.truth("joint").power_stage_on) when_off = scene.velocity("joint");
  });
  scene.robot().network().beginShutdown(scene.now());
  EXPECT_TRUE(scene.runUntil([&] { return scene.robot().network().shutDown(); }, 3s));
  scene.run(100ms);
  EXPECT_LT(std::fabs(when_off), 0.05) << "braked, not left to coast";
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_LT(scene.position("joint") - from, 0.06 * speed + 1.1 * speed * speed / (2.0 * kStopRamp));
}

INSTANTIATE_TEST_SUITE_P(All, FamilyStreams,
                         testing::ValuesIn(familyModesThat([](const FamilyMode& tested) {
                           return tested.mode != std::string("pp");  // which goes to its goal
                         })),
                         familyModeName);
INSTANTIATE_TEST_SUITE_P(All, FamilyStops, testing::ValuesIn(familyModes()), familyModeName);

}  // namespace
}  // namespace cia402
