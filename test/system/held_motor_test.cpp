// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A motor that could not follow does not set off by itself when what held it is gone.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

constexpr double kVelocity = 1.5;  // limit of genericPair()

// The lengths of the stream end it in each phase of being called back.
TEST(HeldMotor, StaysWhereItIsWhenItsLimitSwitchIsReleased) {
  for (const Duration pushed : {300ms, 320ms, 340ms, 360ms, 380ms, 400ms}) {
    ReadyScene scene(genericPair(", simulation: {upper_limit_switch: 0.1}"));
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
    ReadyScene scene(damiaoJoint());
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

// A Damiao calls a target within 0.1 rad reached (6067h), and is disabled for another mode.
TEST(HeldMotor, IsNotLeftWithoutPowerInMotionWhereItIsLetGoWhileItsModeIsSwitched) {
  ReadyScene scene(damiaoJoint());
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "joint", "position_velocity").success);
  double fastest_cut = 0.0;
  bool powered = true;
  scene.watch([&] {
    const bool on = scene.truth("joint").power_stage_on;
    if (powered && !on) {
      fastest_cut = std::max(fastest_cut, std::fabs(scene.velocity("joint")));
    }
    powered = on;
  });
  for (Duration held = 0ms; held < 140ms; held += 1ms) {
    const bool up = scene.position("joint") < 0.0;
    scene.inject("joint", "blocked_rotor");
    EXPECT_EQ(scene.setpoint("joint", scene.position("joint") + (up ? 0.09 : -0.09)), "");
    scene.run(12ms);
    const auto switched = scene.begin(ProcedureKind::set_mode, "joint", "velocity_torque");
    scene.run(held);
    scene.inject("joint", "clear");
    ASSERT_TRUE(scene.runUntil([&] { return switched->has_value(); }, 2s)) << toSeconds(held);
    scene.run(300ms);
    ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "joint", "position_velocity").success);
  }
  EXPECT_LT(fastest_cut, 0.3);
}

TEST(HeldMotor, HasNoSetPointsRunAwayWhileItsBrakeHoldsIt) {
  ReadyScene scene(genericPair(", simulation: {brake_delay: 0.3}"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  const auto enabled = scene.begin(ProcedureKind::enable, "left");
  double highest_target = 0.0;
  const Time end = scene.now() + 2s;
  while (scene.now() < end) {
    (void)scene.setpoint("left", 1.0);
    if (scene.truth("left").power_stage_on && scene.position("left") < 0.01) {
      highest_target = std::max(highest_target, scene.axis("left").target());
    }
    scene.run(4ms);
  }
  ASSERT_TRUE(enabled->has_value());
  EXPECT_TRUE((*enabled)->success) << (*enabled)->message;
  EXPECT_LT(highest_target, 0.02);
  EXPECT_NE(scene.state("left").state, drive::State::fault) << scene.told();
  EXPECT_LT(scene.seen("left").fastest, 1.05 * kVelocity);
  EXPECT_NEAR(scene.position("left"), 1.0, 1e-3);
}

TEST(HeldMotor, HasNoVelocityRunUpWhileItsBrakeHoldsIt) {
  ReadyScene scene(genericPair(", simulation: {brake_delay: 0.3}"), "csv");
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  const auto enabled = scene.begin(ProcedureKind::enable, "left");
  scene.forget();
  double before = 0.0, hardest = 0.0, held = 0.0;
  const Time end = scene.now() + 1500ms;
  while (scene.now() < end) {
    (void)scene.setpoint("left", 1.0);
    scene.run(4ms);
    const double velocity = scene.velocity("left");
    const bool holds = scene.truth("left").power_stage_on && velocity < 0.001;
    if (holds) held = std::max(held, scene.axis("left").target());
    hardest = std::max(hardest, (velocity - before) / 0.004);
    before = velocity;
  }
  ASSERT_TRUE(enabled->has_value());
  EXPECT_TRUE((*enabled)->success) << (*enabled)->message;
  EXPECT_LT(held, 0.05) << "rad/s, told to a motor that is held";
  EXPECT_LT(hardest, 1.5 * 4.0) << "rad/s^2; the limit is 4";
  EXPECT_LT(scene.seen("left").fastest, 1.05 * 1.0);
  EXPECT_NEAR(scene.velocity("left"), 1.0, 0.02);
}

TEST(HeldMotor, HomedWhileItsBrakeHoldsItWaitsForItsRelease) {
  Scene scene(loadText(genericPair(", homing: {method: 37}, simulation: {brake_delay: 0.3}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto homed = scene.begin(ProcedureKind::home, "left");
  double highest_target = 0.0;
  const Time end = scene.now() + 2s;
  while (scene.now() < end) {
    (void)scene.setpoint("left", 1.0);
    if (*homed && scene.position("left") < 0.01) {
      highest_target = std::max(highest_target, scene.axis("left").target());
    }
    scene.run(4ms);
  }
  ASSERT_TRUE(homed->has_value());
  EXPECT_TRUE((*homed)->success) << (*homed)->message;
  EXPECT_LT(highest_target, 0.02);
  EXPECT_LT(scene.seen("left").fastest, 1.05 * kVelocity);
  EXPECT_NEAR(scene.position("left"), 1.0, 1e-3);
}

TEST(HeldMotor, IsWaitedForAlsoAfterItWasHaltedForLong) {
  ReadyScene scene(genericPair(", modes: [csp, pp], simulation: {brake_delay: 0.3}"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "left").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "pp").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt, "left").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "csp").success);
  scene.run(3s);  // a drive that is halted does not follow
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "left").success);
  const auto enabled = scene.begin(ProcedureKind::enable, "left");
  double highest_target = 0.0;
  const Time end = scene.now() + 2s;
  while (scene.now() < end) {
    (void)scene.setpoint("left", 1.0);
    if (scene.position("left") < 0.01) {
      highest_target = std::max(highest_target, scene.axis("left").target());
    }
    scene.run(4ms);
  }
  ASSERT_TRUE(enabled->has_value());
  EXPECT_TRUE((*enabled)->success) << (*enabled)->message;
  EXPECT_LT(highest_target, 0.02);
  EXPECT_LT(scene.seen("left").fastest, 1.05 * kVelocity);
  EXPECT_NEAR(scene.position("left"), 1.0, 1e-3);
}

TEST(HeldMotor, HasItsSetPointsCalledBackAtALimitSwitch) {
  ReadyScene scene(genericPair(", simulation: {upper_limit_switch: 0.5}"));
  scene.forget();
  scene.stream("left", 2.0, 2s);
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): the motor stands while its set-points run"));
  EXPECT_THAT(scene.told(), HasSubstr("internal limit active"));
  EXPECT_LT(scene.axis("left").target(), 0.5 + 0.1);
  scene.forget();
  scene.stream("left", 0.2, 1s);  // the way back is free
  EXPECT_LT(scene.seen("left").fastest, 1.05 * kVelocity);
  EXPECT_NEAR(scene.position("left"), 0.2, 1e-2);
}

TEST(HeldMotor, IsNotLeftWithAVelocityAtALimitSwitch) {
  ReadyScene scene(genericPair(", simulation: {upper_limit_switch: 0.1}"), "csv");
  scene.stream("left", 1.0, 1500ms);
  ASSERT_GT(scene.position("left"), 0.09) << "it did not reach the switch";
  EXPECT_THAT(scene.told(), HasSubstr("the motor stands while it is to turn at"));
  EXPECT_THAT(scene.told(), HasSubstr("The velocity is set to 0"));
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3);
  scene.drive("left").mechanics().positive_limit_switch = 1e9;
  double fastest = 0.0;
  for (int i = 0; i < 30; ++i) {
    scene.run(1ms);
    fastest = std::max(fastest, std::fabs(scene.velocity("left")));
  }
  EXPECT_LT(fastest, 0.5) << "no more than its ramp has come to since";
}

TEST(HeldMotor, TurnsBackFromALimitSwitchByItsRamp) {
  for (const Duration pushed : {310ms, 340ms, 370ms, 400ms}) {  // called back just before, or not
    ReadyScene scene(genericPair(", simulation: {upper_limit_switch: 0.1}"));
    scene.stream("left", 2.0, pushed);
    double before = scene.velocity("left"), hardest = 0.0;
    const Time end = scene.now() + 400ms;
    while (scene.now() < end) {
      ASSERT_EQ(scene.setpoint("left", -1.0), "");
      scene.run(20ms);
      // It may stop at the switch as hard as it can, and has to leave it by its ramp.
      if (scene.velocity("left") < before) {
        hardest = std::max(hardest, (before - scene.velocity("left")) / 0.02);
      }
      before = scene.velocity("left");
    }
    EXPECT_LT(before, -0.5) << "it did not turn back";
    EXPECT_LT(hardest, 1.3 * 4.0) << toSeconds(pushed);
  }
}

}  // namespace
}  // namespace cia402
