// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Homing of whole robots: the joint reads the truth afterwards, whatever the method.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

struct Case {
  int method, direction;
  double home, start;  // rad: where the method finds home, where the joint stands before
};

/// Switches at -2.0, 2.0 and from 0.5 to 0.7; index pulses 0.3 turns of the motor after each turn.
std::string switches(double start) {
  return ", simulation: {initial_position: " + std::to_string(start) +
         ", lower_limit_switch: -2.0, upper_limit_switch: 2.0, home_switch: [0.5, 0.7], "
         "index_offset: 0.3}";
}

std::string homing(int method, double offset, const std::string& more = {}) {
  return ", homing: {method: " + std::to_string(method) + ", offset: " + std::to_string(offset) +
         ", search_velocity: 0.8, zero_velocity: 0.05, acceleration: 4.0" + more + "}";
}

class HomingMethod : public testing::TestWithParam<Case> {};

TEST_P(HomingMethod, MakesTheJointReadItsOffsetAtTheTrueHome) {
  const Case& c = GetParam();
  constexpr double kOffset = 0.25;
  Scene scene(
      loadText(genericPair(homing(c.method, kOffset) + switches(c.start) +
                           ", position_offset: 0.1, direction: " + std::to_string(c.direction))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_FALSE(scene.state("left").homed);
  const auto homed = scene.procedure(ProcedureKind::home, "left");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  ASSERT_TRUE(scene.state("left").homed);
  // Where the joint stands, seen from the true home, is what it says beyond its offset.
  const double said = scene.state("left").position - kOffset;
  EXPECT_NEAR(said, scene.position("left") - c.home, 2e-3);
  EXPECT_TRUE(scene.truth("left").power_stage_on) << "homing ends enabled";
  ASSERT_EQ(scene.setpoint("left", kOffset), "");
  scene.run(4s);
  EXPECT_NEAR(scene.position("left"), c.home, 2e-3);
}

std::string nameOf(const testing::TestParamInfo<Case>& tested) {
  const Case& c = tested.param;
  return "Method" + std::to_string(c.method) + (c.direction < 0 ? "Reversed" : "") +
         (c.start > c.home   ? "FromAbove"
          : c.start < c.home ? "FromBelow"
                             : "");
}

constexpr double kTurn = 6.283185307179586 / 100;  // of the motor, in rad of the joint
// Methods 19 to 22 with the switch on the positive side of the start, and reversed; 23 to 30 hold
// both edges of the switch. A reversed axis sees everything the other way round.
INSTANTIATE_TEST_SUITE_P(
    Methods, HomingMethod,
    testing::Values(Case{17, 1, -2.0, 0.2}, Case{18, 1, 2.0, 0.2}, Case{17, -1, 2.0, 0.2},
                    Case{18, -1, -2.0, 0.2}, Case{19, 1, 0.5, 0.2}, Case{20, 1, 0.5, 0.2},
                    Case{21, 1, 0.7, 1.0}, Case{22, 1, 0.7, 1.0}, Case{19, -1, 0.7, 1.0},
                    Case{24, 1, 0.5, 0.2}, Case{24, 1, 0.5, 1.0}, Case{26, 1, 0.7, 0.2},
                    Case{28, 1, 0.7, 1.0}, Case{30, 1, 0.5, 1.0}, Case{26, -1, 0.5, 0.2},
                    Case{33, 1, 0.1 + 2.3 * kTurn, 0.1 + 2.6 * kTurn},
                    Case{34, 1, 0.1 + 3.3 * kTurn, 0.1 + 2.6 * kTurn},
                    Case{33, -1, 0.1 - 2.3 * kTurn, 0.1 - 2.6 * kTurn}, Case{35, 1, 0.9, 0.9},
                    Case{37, 1, -1.4, -1.4}, Case{37, -1, -1.4, -1.4}),
    nameOf);

TEST(Homing, EndsAtOnceAtAShutdownThatRampsAnotherAxisDown) {
  Scene scene(loadText(
      genericPair(homing(17, 0.0) + switches(0.0),
                  ", limits: {lower: -9.0, upper: 9.0, velocity: 1.5, acceleration: 1.0}")));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
  const auto homed = scene.begin(ProcedureKind::home, "left");
  scene.stream("right", 8.0, 1600ms);
  ASSERT_FALSE(homed->has_value());
  ASSERT_LT(scene.velocity("left"), -0.7);
  ASSERT_GT(scene.velocity("right"), 1.3);
  scene.robot().network().beginShutdown(scene.now());
  scene.run(300ms);  // 0.8 rad/s at 4 rad/s² take 200 ms
  EXPECT_GT(scene.velocity("right"), 0.9) << "its ramp takes 1.5 s";
  EXPECT_NEAR(scene.velocity("left"), 0.0, 0.01);
  ASSERT_TRUE(homed->has_value());
  EXPECT_FALSE((*homed)->success);
  ASSERT_TRUE(scene.runUntil([&] { return scene.robot().network().shutDown(); }, 2s));
  EXPECT_FALSE(scene.truth("left").power_stage_on);
}

TEST(Homing, TimesOutInWordsWhenTheSwitchIsNeverFound) {
  Scene scene(loadText(genericPair(homing(17, 0.0, ", timeout: 2.0"))));
  ASSERT_TRUE(scene.boot());
  const auto homed = scene.procedure(ProcedureKind::home, "left");
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, HasSubstr("left (node 1): homing timed out after 2 s waiting for "
                                       "homing attained"));
  EXPECT_THAT(homed.message, HasSubstr("method 17 (negative limit switch)"));
  scene.run(1s);
  EXPECT_FALSE(scene.state("left").homed);
  EXPECT_FALSE(scene.truth("left").moving);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_THAT(scene.procedure(ProcedureKind::enable, "left").message, HasSubstr("left"));
  EXPECT_THAT(scene.setpoint("left", 0.1), HasSubstr("not homed"));
}

TEST(Homing, QuickStopPreemptsItAndTheDriveStops) {
  Scene scene(loadText(genericPair(homing(17, 0.0) + switches(1.0))));
  ASSERT_TRUE(scene.boot());
  const auto home = scene.begin(ProcedureKind::home, "left");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("left") < -0.5; }, 5s));
  const auto stopped = scene.procedure(ProcedureKind::quick_stop, "left");
  EXPECT_TRUE(stopped.success) << stopped.message;
  ASSERT_TRUE(home->has_value());
  EXPECT_FALSE((*home)->success);
  EXPECT_THAT((*home)->message, HasSubstr("home was stopped by quick_stop while searching home"));
  const double at = scene.position("left");
  scene.run(1s);
  EXPECT_NEAR(scene.position("left"), at, 1e-3);
  EXPECT_FALSE(scene.truth("left").moving);
  EXPECT_FALSE(scene.state("left").homed);
  EXPECT_GT(at, -1.5) << "stopped long before the switch";
}

TEST(Homing, IsNotTakenForStandingWhereItTurnsBack) {
  // At 0.3 rad/s² a drive that turns back is slower than 0.015 rad/s for 0.1 s.
  const std::string slow =
      ", homing: {method: 17, search_velocity: 0.2, zero_velocity: 0.15, acceleration: 0.3}";
  for (Duration later = 0ms; later <= 120ms; later += 8ms) {
    Scene scene(loadText(genericPair(slow + switches(-1.9))));
    ASSERT_TRUE(scene.boot());
    const auto home = scene.begin(ProcedureKind::home, "left");
    ASSERT_TRUE(scene.runUntil(
        [&] { return scene.position("left") < -2.0 && scene.velocity("left") > -0.015; }, 5s));
    scene.run(later);
    ASSERT_FALSE(home->has_value());
    const auto halted = scene.begin(ProcedureKind::halt, "left");
    ASSERT_TRUE(scene.runUntil([&] { return halted->has_value(); }, 2s));
    ASSERT_TRUE((*halted)->success) << (*halted)->message;
    const double at = scene.position("left");
    EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3) << toSeconds(later);
    scene.run(1s);
    EXPECT_NEAR(scene.position("left"), at, 1e-3) << toSeconds(later);
  }
}

TEST(Homing, CancelledItStopsAndStaysEnabledInTheModeFromBefore) {
  Scene scene(loadText(genericPair(homing(17, 0.0) + switches(1.0))));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  const auto home = scene.begin(ProcedureKind::home, "left");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("left") < -0.5; }, 5s));
  scene.axis("left").cancel("the goal was cancelled", scene.now());
  ASSERT_TRUE(scene.runUntil([&] { return home->has_value(); }, 3s));
  EXPECT_FALSE((*home)->success);
  EXPECT_THAT((*home)->message, HasSubstr("the goal was cancelled"));
  scene.forget();
  scene.run(1s);
  EXPECT_LT(scene.seen("left").travel(), 1e-3);
  EXPECT_EQ(scene.state("left").mode->name, "cyclic_position");
  EXPECT_TRUE(scene.truth("left").power_stage_on);
}

TEST(Homing, OfOneAxisLetsTheOtherFollowItsTrajectory) {
  Scene scene(
      loadText(genericPair(homing(17, -2.0) + switches(1.0)) + "  alone: {joints: [right]}\n"));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
  ASSERT_TRUE(scene.move({2.0}, 4s, 1).success);
  scene.run(500ms);
  double worst = 0.0;
  scene.watch([&] {
    if (scene.axis("right").state().ready_for_motion) {
      worst = std::max(worst, std::abs(scene.axis("right").target() - scene.position("right")));
    }
  });
  const auto homed = scene.procedure(ProcedureKind::home, "left");
  ASSERT_TRUE(homed.success) << homed.message;
  EXPECT_NEAR(scene.state("left").position, scene.position("left"), 2e-3);
  scene.run(5s);
  EXPECT_LT(worst, 0.02);
  EXPECT_NEAR(scene.position("right"), 2.0, 1e-3);
  EXPECT_THAT(scene.told(), HasSubstr("alone: goal reached"));
}

TEST(Homing, IsNeededBeforePositionMotionAndSaysSo) {
  Scene scene(loadText(genericPair(homing(17, 0.0) + switches(1.0))));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  EXPECT_THAT(scene.setpoint("left", 0.0), HasSubstr("not homed"));
  const auto refused = scene.move({0.0, 0.0}, 3s);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("not homed"));
  scene.forget();
  scene.run(500ms);
  EXPECT_LT(scene.seen("left").travel(), 1e-3);
  EXPECT_LT(scene.seen("right").travel(), 1e-3);
}

TEST(Homing, GoesByOrderAndStopsTheLaterOnesWhereAnEarlierFails) {
  Scene scene(loadText(
      genericPair(homing(17, 0.0, ", timeout: 1.0, order: 1"), homing(37, 0.0, ", order: 2"))));
  ASSERT_TRUE(scene.boot());
  const auto homed = scene.procedure(ProcedureKind::home);
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, HasSubstr("homing timed out"));
  EXPECT_FALSE(scene.state("right").homed);
}

}  // namespace
}  // namespace cia402
