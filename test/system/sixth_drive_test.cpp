// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive that is two YAML files and nothing else, in test/system/sixth_drive: no line of the
// program knows of it. What the joint does is read from its motor.
#include <cmath>

#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kSixthVelocity = 0.8,
                 kSixthAcceleration = 4.0;  // limits of the joint, rad/s and rad/s^2

/// A joint behind a gear of 30, with the profile of that path.
std::string sixthJoint(const std::string& mode) {
  const std::string folder = cia402::test::testFolder() + "/system/sixth_drive/";
  return "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "axes:\n"
         "  joint: {node_id: 66, drive: " +
         folder + "sixth_drive.yaml, gear_ratio: 30.0, mode: " + mode +
         ", modes: [go, turn, follow],\n"
         "    limits: {lower: -2.5, upper: 2.5, velocity: 0.8, acceleration: 4.0},\n"
         "    simulation: {initial_position: 0.7, drive: " +
         folder + "simulated_drive.yaml}}\n";
}

/// Booted, its place declared, enabled.
struct SixthScene : Scene {
  explicit SixthScene(const std::string& mode) : Scene(loadText(sixthJoint(mode))) {
    EXPECT_TRUE(boot()) << told();
    EXPECT_FALSE(truth("joint").power_stage_on);
    EXPECT_TRUE(declare(*this, "joint", 0.7).success) << told();
    const bus::Answer enabled = procedure(ProcedureKind::enable);
    EXPECT_TRUE(enabled.success) << enabled.message << "\n" << told();
    run(300ms);
    EXPECT_TRUE(truth("joint").power_stage_on);
    EXPECT_LT(seen("joint").travel(), 1e-5) << "it leaps when it is enabled";
  }
  /// Power off by `disable`, from rest.
  void expectDisabled() {
    const bus::Answer disabled = procedure(ProcedureKind::disable);
    EXPECT_TRUE(disabled.success) << disabled.message;
    EXPECT_FALSE(truth("joint").power_stage_on);
  }
  void expectStopsBy(ProcedureKind kind, double ramp) {
    const double from = position("joint"), speed = velocity("joint");
    const bus::Answer stopped = procedure(kind);
    EXPECT_TRUE(stopped.success) << stopped.message;
    EXPECT_NEAR(velocity("joint"), 0.0, 1e-3);
    EXPECT_LT(std::fabs(position("joint") - from),
              0.03 * std::fabs(speed) + 1.1 * speed * speed / (2.0 * ramp));
  }
};

TEST(SixthDrive, GoesToThePlacesThatItIsTold) {
  SixthScene scene("go");
  for (const double goal : {1.3, 0.9, -0.5}) {
    EXPECT_EQ(scene.setpoint("joint", goal), "");
    scene.run(4s);
    EXPECT_NEAR(scene.position("joint"), goal, 1e-4) << scene.told();
  }
  EXPECT_LT(scene.seen("joint").fastest, kSixthVelocity * 1.02);
  EXPECT_GT(scene.seen("joint").fastest, kSixthVelocity * 0.98);
  EXPECT_EQ(scene.setpoint("joint", 1.5), "");
  scene.run(1s);
  ASSERT_GT(scene.velocity("joint"), 0.5);
  scene.expectStopsBy(ProcedureKind::halt, kSixthAcceleration);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
  scene.expectDisabled();
}

TEST(SixthDrive, TurnsAsFastAsItIsToldInEitherDirection) {
  SixthScene scene("turn");
  for (const double speed : {0.5, -0.3}) {
    scene.stream("joint", speed, 800ms);
    EXPECT_NEAR(scene.velocity("joint"), speed, 2e-3);
    EXPECT_NEAR(scene.state("joint").velocity, speed, 2e-3);
  }
  scene.expectStopsBy(ProcedureKind::quick_stop, 2.0 * kSixthAcceleration);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

TEST(SixthDrive, FollowsATrajectory) {
  SixthScene scene("follow");
  ASSERT_TRUE(scene.move({1.9}, 3s).success) << scene.told();
  const Time begun = scene.now();
  double worst = 0.0;
  scene.watch([&] {
    const double share = std::min(1.0, toSeconds(scene.now() - begun) / 3.0);
    const double there = 0.7 + 1.2 * share * share * (3.0 - 2.0 * share);
    worst = std::max(worst, std::fabs(scene.position("joint") - there));
  });
  scene.run(4s);
  EXPECT_LT(worst, 0.6 * 0.02) << "20 ms late at 0.6 rad/s";
  EXPECT_NEAR(scene.position("joint"), 1.9, 1e-4) << scene.told();
  EXPECT_THAT(scene.told(), HasSubstr("goal reached"));
  scene.expectDisabled();
}

TEST(SixthDrive, TakesEachOfItsModesInTurn) {
  SixthScene scene("go");
  for (const char* mode : {"turn", "follow", "go", "follow", "turn", "go"}) {
    scene.forget();
    const bus::Answer switched = scene.procedure(ProcedureKind::set_mode, "joint", mode);
    ASSERT_TRUE(switched.success) << switched.message;
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
    scene.run(200ms);
    EXPECT_LT(scene.seen("joint").travel(), 1e-5) << mode;
    EXPECT_EQ(scene.state("joint").mode->name, mode);
  }
}

TEST(SixthDrive, SaysItsFaultInWordsAndIsClearedByItsObject) {
  SixthScene scene("follow");
  ASSERT_TRUE(scene.move({1.9}, 3s).success) << scene.told();
  scene.run(1500ms);
  scene.inject("joint", "hot");
  scene.run(1s);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr("joint (node 66)"), HasSubstr("0x0051 winding too hot"),
                    HasSubstr("too much load"), HasSubstr("let it cool")));
  scene.inject("joint", "clear");
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_TRUE(cleared.success) << cleared.message;
  EXPECT_EQ(scene.axis("joint").faultText(), "");
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({0.7}, 3s).success) << scene.told();
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), 0.7, 1e-4);
}

}  // namespace
}  // namespace cia402
