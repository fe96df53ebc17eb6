// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Stops of torque modes whose quick stop only lets the torque go: another mode brakes the motor
// before the drive gets it. The motor is the judge.
#include "system/families_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;

/// Hardly any friction: nothing but the driver brakes it.
const char kFreeMotor[] =
    ", simulation: {with: {motor: {friction: 0.001, viscous_friction: 0.02}}}";

class FadingTorque : public testing::TestWithParam<FamilyMode> {
 protected:
  FadingTorque() : scene(loadText(familyJoint(GetParam(), kFreeMotor))) {}
  void turn() {
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
    scene.stream("joint", 5.0, 800ms);
    speed = scene.velocity("joint");
    from = scene.position("joint");
    ASSERT_GT(speed, 0.4);
    scene.forget();
  }
  /// By the ramp of the acceleration limit, once the call has reached the drive. @param reaction s
  void expectRest(double reaction = 0.05) {
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
    EXPECT_LT(scene.position("joint") - from, reaction * speed + 1.1 * speed * speed / (2.0 * 4.0));
    EXPECT_LT(scene.seen("joint").fastest, 1.02 * speed) << "the torque is not let go in motion";
  }

  static constexpr double kNeverOff = 1e9;
  /// From now on the velocity at which the motor loses its power is remembered.
  void watchPower() {
    when_off = kNeverOff;
    scene.watch([&] {
      if (when_off == kNeverOff && !scene.truth("joint").power_stage_on) {
        when_off = scene.velocity("joint");
      }
    });
  }

  void cutOff(Duration time) {
    scene.inject("joint", "silent");
    scene.run(time);
    from = scene.position("joint");
    speed = scene.velocity("joint");
    scene.forget();
    scene.inject("joint", "clear");
  }

  Scene scene;
  double speed = 0.0, from = 0.0, when_off = kNeverOff;
};

// The simulation, without a brake of its own: what the tests below would see else.
TEST_P(FadingTorque, CoastsByTheQuickStopOfTheDriveAlone) {
  turn();
  ASSERT_EQ(scene.drive("joint").dictionary().write({0x6040, 0}, {0x02, 0x00}), 0U);
  scene.run(200ms);
  EXPECT_GT(scene.velocity("joint"), 0.9 * speed);
}

// As where SYNC comes at a wrong rate.
TEST_P(FadingTorque, IsBrakedByAModeBesideTheCycle) {
  turn();
  watchPower();
  scene.axis("joint").stopBesideCycle("nothing else is heard");
  scene.run(2s);
  EXPECT_LT(std::fabs(when_off), 0.05) << "braked, not left to coast";
  expectRest();
  EXPECT_FALSE(scene.truth("joint").power_stage_on) << scene.told();
}

// What it is told in cycles does not reach it at all.
TEST_P(FadingTorque, IsBrakedByAModeWhereItsRpdosAreLost) {
  turn();
  watchPower();
  for (const canopen::PdoImage::Pdo& pdo : scene.node("joint").image().rpdos()) {
    sim::FaultRule lost;
    lost.id = pdo.cob_id;
    lost.receiver = "joint";
    scene.world().bus().faults().add(lost);
  }
  scene.axis("joint").stopBesideCycle("nothing else is heard");
  scene.run(2s);
  EXPECT_LT(std::fabs(when_off), 0.05) << "braked, not left to coast";
  expectRest();
}

TEST_P(FadingTorque, IsBrakedBeforeItsQuickStop) {
  turn();
  const bus::Answer stopped = scene.procedure(ProcedureKind::quick_stop);
  EXPECT_TRUE(stopped.success) << stopped.message;
  expectRest();
  // Later it is enabled in the mode that pushed, and stands there.
  scene.run(1s);
  const double stood = scene.position("joint");
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_EQ(scene.axis("joint").modeName(), drive::canonicalModeName(GetParam().mode));
  EXPECT_NEAR(scene.position("joint"), stood, 1e-4);
}

TEST_P(FadingTorque, IsBrakedBeforeItIsDisabled) {
  turn();
  const bus::Answer disabled = scene.procedure(ProcedureKind::disable);
  EXPECT_TRUE(disabled.success) << disabled.message;
  expectRest();
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

TEST_P(FadingTorque, IsBrakedAtAShutdown) {
  turn();
  scene.robot().network().beginShutdown(scene.now());
  ASSERT_TRUE(scene.runUntil([&] { return scene.robot().network().shutDown(); }, 2s));
  expectRest();
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

// It hears what it is told, but nothing usable comes from it.
TEST_P(FadingTorque, IsBrakedByAModeWhereItIsNotHeard) {
  turn();
  watchPower();
  scene.inject("joint", "short_tpdos");
  scene.run(3s);
  EXPECT_THAT(scene.told(), testing::HasSubstr("is to brake it, then quick stop is commanded"));
  EXPECT_LT(std::fabs(when_off), 0.05);
  expectRest(0.1);
}

// The velocity of a stream that has ended long ago is nobody's any more.
TEST_P(FadingTorque, StandsThatIsNotHeardAtRest) {
  turn();
  scene.run(1s);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  ASSERT_EQ(scene.axis("joint").modeName(), drive::canonicalModeName(GetParam().mode));
  scene.run(500ms);
  scene.forget();
  scene.inject("joint", "short_tpdos");
  scene.run(3s);
  EXPECT_LT(scene.seen("joint").travel(), 1e-3);
  EXPECT_FALSE(scene.truth("joint").power_stage_on) << scene.told();
}

// Cut off for a moment it hears nothing, and turns on by its torque. What it hears first then is
// the mode that brakes.
TEST_P(FadingTorque, IsBrakedByAModeWhenItIsBack) {
  turn();
  watchPower();
  cutOff(130ms);
  scene.run(3s);
  EXPECT_LT(std::fabs(when_off), 0.05) << "no quick stop lets it go, until it stands";
  expectRest();
  EXPECT_TRUE(scene.procedure(ProcedureKind::recover).success) << scene.told();
  EXPECT_EQ(scene.axis("joint").modeName(), drive::canonicalModeName(GetParam().mode));
}

// A drive that does not notice a dead master, and is cut off for so long that it is lost: it is
// braked as it is configured again. (The DM5 notices, and lets its motor go by itself.)
class UnwatchedTorque : public FadingTorque {};
TEST_P(UnwatchedTorque, IsBrakedByAModeWhenItIsFoundAgain) {
  turn();
  watchPower();
  cutOff(1200ms);
  scene.run(1s);
  EXPECT_LT(std::fabs(when_off), 0.05) << "braked, not left to coast";
  expectRest(0.3);
}

// A new driver finds it turning by the torque of one that is gone. What it tells the drive first,
// the NMT command and the quick stop, would let the motor go.
TEST_P(FadingTorque, IsBrakedByTheNextDriver) {
  turn();
  for (const bool reset : {true, false}) {
    watchPower();
    scene.node("joint").boot(scene.now(), reset);
    scene.run(1s);
    EXPECT_LT(std::fabs(when_off), 0.05) << "braked, not left to coast";
    expectRest();
    ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 10s)) << scene.told();
    EXPECT_TRUE(scene.procedure(ProcedureKind::recover).success) << scene.told();
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
    scene.stream("joint", 4.0, 700ms);
    speed = scene.velocity("joint");
    from = scene.position("joint");
    scene.forget();
  }
}

INSTANTIATE_TEST_SUITE_P(All, FadingTorque,
                         testing::Values(FamilyMode{"id286_cnfa", "10000", "pt"},
                                         FamilyMode{"megmeet_dm5", "8388608", "pt"},
                                         FamilyMode{"megmeet_dm5", "8388608", "cst"}),
                         [](const auto& tested) {
                           return std::string(tested.param.family) + "_" + tested.param.mode;
                         });
INSTANTIATE_TEST_SUITE_P(All, UnwatchedTorque,
                         testing::Values(FamilyMode{"id286_cnfa", "10000", "pt"}),
                         [](const auto&) { return "id286_cnfa_pt"; });

}  // namespace
}  // namespace cia402
