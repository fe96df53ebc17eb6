// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The limits that a drive keeps (607Dh) count from its own zero. Whatever that zero is: enabling
// moves nothing, and motion ends where it was told to.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

constexpr double kCountsPerRad = 131072.0 * 100.0 / 6.283185307179586;

/// 607Dh of the drive, in rad.
double limitIn(Scene& scene, const std::string& name, std::uint8_t subindex) {
  const auto* entry = scene.drive(name).dictionary().find({0x607D, subindex});
  return static_cast<std::int32_t>(entry->number) / kCountsPerRad;
}
double lowest(Scene& scene, const std::string& name) { return limitIn(scene, name, 1); }
double highest(Scene& scene, const std::string& name) { return limitIn(scene, name, 2); }

std::string limits(double lower, double upper) {
  return ", limits: {lower: " + std::to_string(lower) + ", upper: " + std::to_string(upper) +
         ", velocity: 1.5, acceleration: 4.0, jerk: 40.0, effort: 120.0}";
}

std::string standing(double at, const std::string& more = {}) {
  return ", simulation: {initial_position: " + std::to_string(at) + more + "}";
}

/// Searches the lower switch at -0.5 from 0.0; the joint reads `offset` there.
std::string homed(double offset) {
  return ", homing: {method: 17, search_velocity: 0.8, zero_velocity: 0.05, acceleration: 4.0, "
         "offset: " +
         std::to_string(offset) + "}" + standing(0.0, ", lower_limit_switch: -0.5");
}

TEST(Coordinates, EnablingBeforeHomingMovesNothingThoughTheDrivesZeroIsOutsideTheLimits) {
  Scene scene(loadText(genericPair(homed(0.25) + limits(0.2, 2.0))));
  ASSERT_TRUE(scene.boot());
  scene.forget();
  const auto recovered = scene.procedure(ProcedureKind::recover);
  EXPECT_THAT(recovered.message, HasSubstr("left is not homed: home"));
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  scene.run(500ms);
  expectNothingMoved(scene, "left");
  const auto home = scene.procedure(ProcedureKind::home, "left");
  ASSERT_TRUE(home.success) << home.message << scene.told();
  EXPECT_NEAR(lowest(scene, "left"), 0.2, 1e-6);
  EXPECT_NEAR(highest(scene, "left"), 2.0, 1e-6);
  ASSERT_EQ(scene.setpoint("left", 1.9), "");
  scene.run(4s);
  EXPECT_NEAR(scene.position("left"), -0.5 + (1.9 - 0.25), 2e-3);
}

TEST(Coordinates, HomeOutsideTheLimitsIsLeftWithoutAJump) {
  Scene scene(loadText(genericPair(homed(-0.1) + limits(0.2, 2.0))));
  ASSERT_TRUE(scene.boot());
  const auto home = scene.procedure(ProcedureKind::home, "left");
  ASSERT_TRUE(home.success) << home.message << scene.told();
  const double at = scene.position("left");
  scene.forget();
  scene.run(500ms);
  expectNothingMoved(scene, "left");
  ASSERT_EQ(scene.setpoint("left", 0.5), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("left") - at, 0.6, 5e-3);
  EXPECT_LT(scene.seen("left").fastest, 1.5 * 1.02);
  EXPECT_NEAR(lowest(scene, "left"), 0.2, 1e-6) << "closed once the axis came back";
}

TEST(Coordinates, ADriveThatCameBackWithOldLimitsIsEnabledWithoutMotion) {
  Scene scene(loadText(genericPair(homed(0.25) + limits(0.2, 2.0))));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "left").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "left").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::save_parameters, "left").success);
  scene.inject("left", "power_cycle");  // the encoder counts from 0 then
  scene.run(1s);
  ASSERT_FALSE(scene.state("left").homed);
  scene.forget();
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_THAT(recovered.message, HasSubstr("left is not homed: home"));
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  scene.run(500ms);
  expectNothingMoved(scene, "left");
}

TEST(Coordinates, AnAxisFoundOutsideItsLimitsIsEnabledWithoutMotionAndComesBack) {
  Scene scene(loadText(genericPair(standing(2.7))));
  ASSERT_TRUE(scene.boot());
  scene.forget();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  scene.run(500ms);
  expectNothingMoved(scene, "left");
  ASSERT_EQ(scene.setpoint("left", 3.5), "");
  scene.run(1s);
  expectNothingMoved(scene, "left");
  ASSERT_EQ(scene.setpoint("left", 2.65), "");
  scene.run(1s);
  EXPECT_NEAR(scene.position("left"), 2.65, 1e-3) << "as far as it is told";
  ASSERT_EQ(scene.setpoint("left", 2.0), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("left"), 2.0, 1e-3);
  EXPECT_LT(scene.seen("left").fastest, 1.5 * 1.02);
  EXPECT_NEAR(highest(scene, "left"), 2.5, 1e-6);
}

// An axis with an absolute encoder has its limits again as soon as its homing is stopped, and comes
// to rest beyond them.
TEST(Coordinates, AHomingThatWasHaltedOutsideTheLimitsIsLeftWithoutMotion) {
  Scene scene(loadText(genericPair(
      ", homing: {method: 17, search_velocity: 0.8, zero_velocity: 0.05, acceleration: 4.0, "
      "required: false}, simulation: {initial_position: -2.2, lower_limit_switch: -2.8}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.state("left").homed);
  const auto homing = scene.begin(ProcedureKind::home, "left");
  ASSERT_TRUE(scene.runUntil([&] { return scene.position("left") < -2.49; }, 3s));
  const auto halted = scene.procedure(ProcedureKind::halt, "left");
  ASSERT_TRUE(halted.success) << halted.message;
  ASSERT_LT(scene.position("left"), -2.51) << "the lower limit is -2.5";
  scene.run(200ms);
  scene.forget();
  const auto enabled = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_TRUE(enabled.success) << enabled.message;
  scene.run(500ms);
  expectNothingMoved(scene, "left");
  ASSERT_EQ(scene.setpoint("left", -2.4), "");
  scene.run(1s);
  EXPECT_NEAR(scene.position("left"), -2.4, 1e-3);
}

TEST(Coordinates, APlannedMotionFromOutsideTheLimitsGoesAsFarAsItIsTold) {
  Scene scene(loadText(genericPair(standing(2.7) + ", mode: profile_position")));
  ASSERT_TRUE(scene.boot());
  scene.forget();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  ASSERT_EQ(scene.setpoint("left", 3.5), "");
  scene.run(1s);
  expectNothingMoved(scene, "left");
  ASSERT_EQ(scene.setpoint("left", 2.65), "");
  scene.run(1s);
  EXPECT_NEAR(scene.position("left"), 2.65, 1e-3);
}

TEST(Coordinates, AHeldMotorThatIsToldToReadOtherwiseForgetsWhereItWasGoing) {
  // Wide enough for the drive not to fault before the call is answered.
  const std::string window = ", write: [{object: following_error_window, value: 0.2}]";
  for (const std::string& yaml : {genericPair(window), damiaoJoint()}) {
    ReadyScene scene(yaml, "profile_position");
    const std::string axis = scene.loaded().robot.axes[0].name;
    const double from = scene.position(axis);
    scene.inject(axis, "blocked_rotor");
    ASSERT_EQ(scene.setpoint(axis, from - 1.0), "");
    scene.run(10ms);
    drive::ProcedureRequest request;
    request.kind = ProcedureKind::set_position;
    request.position = 2.0;
    const auto declared = call(scene, bus::ProcedureCommand{axis, request});
    ASSERT_TRUE(declared.success) << declared.message;
    scene.inject(axis, "clear");
    scene.forget();
    scene.run(3s);
    EXPECT_NEAR(scene.position(axis), from, 0.02) << axis;
    EXPECT_LT(scene.seen(axis).travel(), 0.3) << axis << " springs back, and goes nowhere";
  }
}

/// Homed where they stand: by the drive's method 37 or its older number, or by the driver.
TEST(Coordinates, DeclaringAHaltedAxisHomeMovesNothing) {
  for (const std::string& yaml :
       {genericPair(", homing: {method: 37, offset: 0.7, required: false}"),
        genericPair(", homing: {method: 35, offset: 0.7, required: false}"),
        damiaoJoint(", homing: {offset: 0.7, required: false}")}) {
    for (const char* mode : {"cyclic_position", "profile_position"}) {
      ReadyScene scene(yaml, mode);
      const std::string axis = scene.loaded().robot.axes[0].name;
      scene.stream(axis, scene.state(axis).position - 1.0, 400ms);
      ASSERT_LT(scene.velocity(axis), -0.5) << axis;
      ASSERT_TRUE(scene.procedure(ProcedureKind::halt, axis).success);
      scene.run(300ms);
      const double stood = scene.position(axis);
      scene.forget();
      const auto home = scene.procedure(ProcedureKind::home, axis);
      ASSERT_TRUE(home.success) << home.message << scene.told();
      EXPECT_NEAR(scene.state(axis).position, 0.7, 1e-3);
      const bool streams = scene.axis(axis).setPoint().kind() == drive::SetPointKind::stream;
      if (streams) {
        EXPECT_NEAR(scene.axis(axis).target(), 0.7, 1e-3) << axis;
      }
      scene.run(500ms);
      ASSERT_TRUE(scene.procedure(ProcedureKind::enable, axis).success) << scene.told();
      scene.run(500ms);
      expectNothingMoved(scene, axis);
      ASSERT_EQ(scene.setpoint(axis, 0.5), "");
      scene.run(2s);
      EXPECT_NEAR(scene.position(axis), stood + (0.5 - 0.7), 2e-3) << axis << " in " << mode;
    }
  }
}

class Declared : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(scene.boot());
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  }
  Scene scene{loadText(genericPair(limits(-0.5, 0.5)))};
};

TEST_F(Declared, PositionMovesTheDrivesLimitsAlong) {
  scene.forget();
  const auto declared = declare(scene, "left", 0.4);
  ASSERT_TRUE(declared.success) << declared.message;
  expectNothingMoved(scene, "left");
  EXPECT_NEAR(lowest(scene, "left"), -0.9, 1e-6);
  EXPECT_NEAR(highest(scene, "left"), 0.1, 1e-6);
  ASSERT_TRUE(scene.move({-0.45, 0.0}, 3s).success);
  scene.run(4s);
  EXPECT_THAT(scene.told(), HasSubstr("goal reached"));
  EXPECT_NEAR(scene.position("left"), -0.45 - 0.4, 1e-3);
}

TEST_F(Declared, PositionOfADisabledAxisMovesTheDrivesLimitsAlong) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "left").success);
  ASSERT_TRUE(declare(scene, "left", -0.3).success);
  EXPECT_NEAR(lowest(scene, "left"), -0.2, 1e-6);
  EXPECT_NEAR(highest(scene, "left"), 0.8, 1e-6);
}

TEST_F(Declared, PositionOutsideTheLimitsMovesNothing) {
  scene.forget();
  ASSERT_TRUE(declare(scene, "left", 0.8).success);
  scene.run(500ms);
  expectNothingMoved(scene, "left");
  ASSERT_EQ(scene.setpoint("left", 0.3), "");
  scene.run(2s);
  EXPECT_NEAR(scene.position("left"), 0.3 - 0.8, 1e-3);
}

TEST_F(Declared, PositionFarAwayLeavesLimitsOpenThatTheDriveCannotCount) {
  // 131072 * 100 counts a turn: 32 bits hold 1029 rad each way.
  scene.forget();
  ASSERT_TRUE(declare(scene, "left", -1500.0).success);
  scene.run(100ms);
  expectNothingMoved(scene, "left");
  EXPECT_NEAR(highest(scene, "left"), 2147483647 / kCountsPerRad, 1e-6);
  EXPECT_NEAR(lowest(scene, "left"), -2147483648.0 / kCountsPerRad, 1e-6);
}

TEST_F(Declared, PositionOutlivesALostNodeWithItsLimits) {
  ASSERT_TRUE(declare(scene, "left", 0.4).success);
  scene.inject("left", "silent");
  scene.run(1s);
  scene.inject("left", "clear");
  scene.forget();
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  ASSERT_TRUE(recovered.success) << recovered.message << scene.told();
  scene.run(200ms);
  expectNothingMoved(scene, "left");
  EXPECT_NEAR(lowest(scene, "left"), -0.9, 1e-6);
  ASSERT_EQ(scene.setpoint("left", -0.45), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("left"), -0.45 - 0.4, 1e-3);
}

TEST(Coordinates, MinusZeroIsNeverSentBackToTheDrive) {
  LoadedRobot loaded = loadText(damiaoJoint());
  loaded.drives[0].mechanics[0].initial_position = -0.0;
  Scene scene(std::move(loaded));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_EQ(scene.drive("joint").dictionary().find({0x6064, 0})->number, 0x80000000u);
  const auto recovered = scene.procedure(ProcedureKind::recover);
  EXPECT_TRUE(recovered.success) << recovered.message;
  scene.run(200ms);
  EXPECT_EQ(scene.badFloats(), 0u);
  EXPECT_TRUE(scene.truth("joint").power_stage_on) << scene.told();
  EXPECT_LT(scene.seen("joint").travel(), 1e-6);
}

TEST(Coordinates, AGoalThatTheDriveDidNotReachIsNotCalledReached) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  // Somebody else's limit in the drive: +0.6 rad.
  scene.drive("left").dictionary().find({0x607D, 2})->number = 1251645;
  ASSERT_TRUE(scene.move({1.0, 1.0}, 3s).success);
  scene.run(6s);
  ASSERT_NEAR(scene.position("left"), 0.6, 1e-3) << "the drive clamps";
  EXPECT_THAT(scene.told(), Not(HasSubstr("goal reached")));
  EXPECT_THAT(scene.told(), HasSubstr("left"));
}

TEST(Coordinates, SwitchingToPositionsBeyondALimitMovesNothing) {
  for (const char* back : {"cyclic_position", "profile_position"}) {
    Scene scene(loadText(genericPair(limits(-1.0, 1.0) + standing(0.6) +
                                     ", modes: [csp, pp, pt], write: "
                                     "[{object: following_error_window, value: 0.05}]")));
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(declare(scene, "left", 0.6).success);
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "profile_torque").success);
    scene.stream("left", 60.0, 700ms);
    scene.run(2s);
    ASSERT_GT(scene.position("left"), 1.003) << "the brake ends a little beyond the limit";
    scene.forget();
    const auto switched = scene.procedure(ProcedureKind::set_mode, "left", back);
    EXPECT_TRUE(switched.success) << switched.message;
    scene.run(500ms);
    expectNothingMoved(scene, "left");
  }
}

TEST(Coordinates, ADriveThatKeepsItsLimitsIsNotSwitchedToPositionsBeyondThem) {
  Scene scene(loadText(genericPair(limits(-1.0, 1.0) + standing(0.6) +
                                   ", modes: [csp, pt], write: "
                                   "[{object: following_error_window, value: 0.05}]")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(declare(scene, "left", 0.6).success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "profile_torque").success);
  for (const auto side : {std::uint8_t{1}, std::uint8_t{2}}) {  // only in other states
    scene.drive("left").dictionary().onWriteCheck({0x607D, side},
                                                  [](const auto&, auto) { return 0x08000022u; });
  }
  scene.stream("left", 60.0, 700ms);
  scene.run(2s);
  ASSERT_GT(scene.position("left"), 1.003) << "the brake ends a little beyond the limit";
  scene.forget();
  const auto refused = scene.procedure(ProcedureKind::set_mode, "left", "csp");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("lead it back by a velocity or an effort, or disable it"));
  EXPECT_THAT(refused.message, HasSubstr("607D:02"));
  EXPECT_EQ(scene.axis("left").modeName(), "profile_torque");
  scene.run(500ms);
  expectNothingMoved(scene, "left");
}

}  // namespace
}  // namespace cia402
