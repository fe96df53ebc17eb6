// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// An effort pushes a motor without load: what keeps its speed and its way within the limits.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;

constexpr double kVelocity = 1.5, kAcceleration = 4.0, kUpper = 2.5,
                 kCycle = 0.004;  // genericPair()
constexpr double kEffort = 60.0;  // N m
constexpr double kTwoPi = 6.283185307179586;
// The simulated rotor: 300 motor turns/s^2 by the rated 0.64 N m, here on 100 turns.
constexpr double kPushed = kEffort / (0.64 * 100.0) * 300.0 / 100.0 * kTwoPi;

struct Pushed : Scene {
  explicit Pushed(const std::string& more, const std::string& mode)
      : Scene(loadText(genericPair(", modes: [csp, pt, cst]" + more))) {
    EXPECT_TRUE(boot()) << told();
    const bus::Answer set = procedure(ProcedureKind::set_mode, "left", mode);
    EXPECT_TRUE(set.success) << set.message;
    const bus::Answer enabled = procedure(ProcedureKind::enable, "left");
    EXPECT_TRUE(enabled.success) << enabled.message;
    run(100ms);
    forget();
  }
  /// @return what the last set-point was refused with, "" if all were taken
  std::string push(double effort, Duration duration) {
    std::string refused;
    for (const Time end = now() + duration; now() < end && refused.empty();) {
      refused = setpoint("left", effort);
      run(4ms);
    }
    return refused;
  }
};

// 6087h: the limit of effort in a twentieth of a second; in thousandths of the rated torque, or N
// m.
TEST(EffortSlope, IsToldToADriveThatHasOneInItsTorqueMode) {
  Pushed scene("", "profile_torque");
  const auto* slope = scene.drive("left").dictionary().find({0x6087, 0});
  EXPECT_NEAR(static_cast<double>(slope->number), 120.0 / (0.64 * 100.0) * 1000.0 * 20.0, 1.0);
  double speed = 0.0, pushed = 0.0, steepest = 0.0;
  for (int i = 0; i < 40; ++i) {
    ASSERT_EQ(scene.setpoint("left", kEffort), "");
    scene.run(1ms);
    const double gained = (scene.velocity("left") - speed) / 0.001;
    steepest = std::max(steepest, gained - pushed);
    pushed = gained;
    speed = scene.velocity("left");
  }
  EXPECT_LT(steepest, 1.2 * kPushed / 25.0) << "rad/s^2 in a millisecond, of 25 to half the limit";
  EXPECT_GT(pushed, 0.9 * kPushed);
}

TEST(EffortSlope, IsToldToADamiaoInItsTorqueModes) {
  Scene scene(loadText(damiaoJoint(", modes: [csp, profile_torque]")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "joint", "profile_torque").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "joint").success);
  const auto* slope = scene.drive("joint").dictionary().find({0x6087, 0});
  EXPECT_EQ(slope->number, 0x42C80000u) << "100.0f: 20 times 5 N m";
}

class EffortLimits : public testing::TestWithParam<const char*> {};

TEST_P(EffortLimits, TheDriveIsToldTheLimitOfSpeed) {
  Pushed scene("", GetParam());
  const auto* speed = scene.drive("left").dictionary().find({0x6080, 0});
  // 1.5 rad/s on 100 turns of the motor, in 1/min, and a twentieth more.
  EXPECT_NEAR(static_cast<double>(speed->number), 1.05 * kVelocity * 100.0 / kTwoPi * 60.0, 1.0);
}

TEST_P(EffortLimits, ADriveWithoutALimitOfSpeedKeepsItAllTheSame) {
  Pushed scene(", write: [{object: \"6080:00\", raw: 600000}]", GetParam());
  EXPECT_EQ(scene.push(kEffort, 1s), "");
  // The velocity comes with every second SYNC, and what follows from it counts from the next on.
  EXPECT_LT(scene.seen("left").fastest, kVelocity + 4 * kCycle * kPushed);
  EXPECT_GT(scene.seen("left").fastest, 0.8 * kVelocity) << "the test pushed too little";
  EXPECT_EQ(scene.push(-kEffort, 1s), "");
  EXPECT_LT(scene.seen("left").fastest, kVelocity + 4 * kCycle * kPushed);
}

TEST_P(EffortLimits, NoEffortKeepsAnAxisFromStoppingInFrontOfALimitOfPosition) {
  // Pushed on, let go, held against, and driven back, from when it is half a radian from the limit.
  for (const double then : {kEffort, 0.0, -1e-9, -1.0, -kEffort}) {
    Pushed scene("", GetParam());
    for (int i = 0; i < 2000 && scene.position("left") < kUpper - 0.5; ++i) {
      ASSERT_EQ(scene.setpoint("left", kEffort), "");
      scene.run(4ms);
    }
    EXPECT_GT(scene.velocity("left"), 0.9 * kVelocity);
    // Taken or refused, as the mode has a brake of its own or not.
    for (int i = 0; i < 500; ++i) {
      (void)scene.setpoint("left", then);
      scene.run(4ms);
    }
    EXPECT_LT(scene.seen("left").highest, kUpper + 0.01) << then << " N m\n" << scene.told();
    if (then >= 0.0) {
      EXPECT_GT(scene.seen("left").highest, kUpper - 0.2) << "it was braked early";
    }
    if (then == -kEffort) continue;  // it turns back before that
    EXPECT_THAT(scene.told(), testing::HasSubstr("comes to its limit of position 2.500 rad"));
    EXPECT_THAT(scene.told(), testing::HasSubstr("an effort that leads back"));
    EXPECT_THAT(scene.told(), testing::Not(testing::HasSubstr("coast")));
  }
}

TEST_P(EffortLimits, AnAxisThatCoastsToALimitTakesOnlyWhatSlowsItDown) {
  Pushed scene(", command_timeout_action: coast", GetParam());
  ASSERT_TRUE(scene.runUntil(
      [&] {
        (void)scene.setpoint("left", kEffort);
        return scene.position("left") > kUpper - 0.5;
      },
      5s));
  const std::string refused = scene.push(kEffort, 500ms);
  EXPECT_THAT(refused, testing::HasSubstr("comes to its limit of position 2.500 rad"));
  EXPECT_THAT(refused, testing::HasSubstr("only an effort that slows it down"));
  EXPECT_NE(scene.setpoint("left", 0.0), "");
  EXPECT_LT(scene.position("left"), kUpper - 0.2);
  const double speed = scene.velocity("left");
  scene.run(40ms);
  EXPECT_NEAR(scene.velocity("left"), speed, 0.05) << "it was to coast";
  EXPECT_THAT(scene.told(), testing::Not(testing::HasSubstr("braked")));
  EXPECT_EQ(scene.push(-kEffort, 500ms), "");
  EXPECT_LT(scene.seen("left").highest, kUpper);
}

TEST_P(EffortLimits, AnAxisAtALimitIsPushedBackFromIt) {
  Pushed scene("", GetParam());
  for (int i = 0; i < 1000; ++i) {
    (void)scene.setpoint("left", kEffort);
    scene.run(4ms);
  }
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  EXPECT_EQ(scene.push(-kEffort, 500ms), "");
  EXPECT_LT(scene.position("left"), kUpper - 0.3);
}

INSTANTIATE_TEST_SUITE_P(Modes, EffortLimits, testing::Values("profile_torque", "cyclic_torque"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace cia402
