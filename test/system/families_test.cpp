// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Families in each of their modes with their simulated drives: what the joint does is read from the
// motor.
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kNoMove = 1e-5;  // rad

class Family : public testing::TestWithParam<FamilyMode> {
 protected:
  /// Gives what the mode takes, until the joint is at rest at a goal, or turns.
  static void command(Scene& scene, const drive::ModeSpec& mode, double value) {
    if (mode.kind != ControlKind::position) return scene.stream("joint", value, 800ms);
    if (mode.cyclic) {
      EXPECT_TRUE(scene.move({value}, 2s).success);
    } else {
      EXPECT_EQ(scene.setpoint("joint", value), "");
    }
    scene.run(5s);
  }
};

TEST_P(Family, StandsWhenEnabledMovesAsItIsToldAndStops) {
  Scene scene(loadText(familyJoint(GetParam())));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.forget();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message;
  scene.run(500ms);
  EXPECT_LT(scene.seen("joint").travel(), kNoMove);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);

  const drive::ModeSpec* mode = scene.state("joint").mode;
  ASSERT_NE(mode, nullptr);
  if (mode->kind == ControlKind::position) {
    command(scene, *mode, scene.state("joint").position + 0.6);
    EXPECT_NEAR(scene.position("joint"), 0.6, 1e-4) << scene.told();
  } else if (mode->kind == ControlKind::velocity) {
    command(scene, *mode, 0.5);
    EXPECT_NEAR(scene.velocity("joint"), 0.5, 2e-3) << "1 rpm of the motor is 2.1e-3 rad/s";
    EXPECT_NEAR(scene.state("joint").velocity, 0.5, 2.1e-3);
  } else {
    command(scene, *mode, 5.0);
    EXPECT_GT(scene.velocity("joint"), 0.3);
  }
  const bus::Answer halted = scene.procedure(ProcedureKind::halt);
  EXPECT_TRUE(halted.success) << halted.message;
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
  EXPECT_LT(scene.seen("joint").fastest, 0.8 * 1.05);
  const bus::Answer disabled = scene.procedure(ProcedureKind::disable);
  EXPECT_TRUE(disabled.success) << disabled.message;
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

TEST_P(Family, BrakesByAQuickStop) {
  Scene scene(loadText(familyJoint(GetParam())));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  const drive::ModeSpec* mode = scene.state("joint").mode;
  ASSERT_NE(mode, nullptr);
  const bool goal = mode->kind == ControlKind::position;
  if (goal && mode->cyclic) {
    EXPECT_TRUE(scene.move({1.2}, 3s).success);
  } else if (goal) {
    EXPECT_EQ(scene.setpoint("joint", 1.2), "");
  } else {
    scene.stream("joint", mode->kind == ControlKind::velocity ? 0.5 : 5.0, 800ms);
  }
  if (goal) scene.run(1s);
  const double speed = scene.velocity("joint"), from = scene.position("joint");
  ASSERT_GT(speed, 0.3);
  const bus::Answer stopped = scene.procedure(ProcedureKind::quick_stop);
  EXPECT_TRUE(stopped.success) << stopped.message;
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  // By twice the acceleration limit, once the call has reached the drive; torques by the limit
  // itself, as another mode brakes them.
  const double ramp = mode->kind == ControlKind::torque ? 4.0 : 8.0;
  EXPECT_LT(scene.position("joint") - from, 0.03 * speed + 1.1 * speed * speed / (2.0 * ramp));
}

INSTANTIATE_TEST_SUITE_P(All, Family, testing::ValuesIn(familyModes()), familyModeName);

constexpr char kReverseLimitAtDi1[] = ", write: [{object: di1_function, raw: 36}]";  // P03.00

/// A family with what one of its faults is called, in the simulation and in words.
struct FamilyFault {
  FamilyMode tested;
  const char *fault, *code, *words;
};

class FamilyWith : public testing::TestWithParam<FamilyFault> {};

TEST_P(FamilyWith, AFaultSaysSoInWordsAndIsCleared) {
  const FamilyFault& known = GetParam();
  Scene scene(loadText(familyJoint(known.tested)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.inject("joint", known.fault);
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr(known.code), HasSubstr(known.words)));
  if (known.tested.family == std::string(kMegmeetDm5)) {  // [L1424]
    EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("; the drive lets the motor coast; "));
  }
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_TRUE(cleared.success) << cleared.message;
  EXPECT_EQ(scene.axis("joint").faultText(), "");
}

TEST_P(FamilyWith, ANegativeLimitSwitchIsFoundAsHome) {
  const FamilyMode& tested = GetParam().tested;
  const bool by_function = tested.family == std::string(kMegmeetDm5);
  const char* told = tested.family == std::string(kNimotionStepper) ? kNimotionSwitches : "";
  Scene scene(
      loadText(familyJoint(tested,
                           ", homing: {method: 17, search_velocity: 0.3, zero_velocity: 0.05,"
                           " acceleration: 2.0}, simulation: {lower_limit_switch: -0.4}" +
                               std::string(by_function ? kReverseLimitAtDi1 : told))));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  ASSERT_TRUE(homed.success) << homed.message;
  EXPECT_NEAR(scene.state("joint").position, scene.position("joint") + 0.4, 2e-3);
  EXPECT_NEAR(scene.position("joint"), -0.4, 0.02);
  EXPECT_TRUE(scene.state("joint").homed);
}

INSTANTIATE_TEST_SUITE_P(
    All, FamilyWith,
    testing::Values(
        FamilyFault{{kNimotionStepper, "4000", "csp"},
                    "over_voltage",
                    "0x3110",
                    "over voltage: the bus is above 2001h:01"},
        FamilyFault{{kId286Cnfa, "10000", "pp"},
                    "over_voltage",
                    "0x000E",
                    "supply over-voltage: braking returns more"},
        FamilyFault{{kMegmeetDm5, "8388608", "csp"},
                    "overvoltage",
                    "0xFF02",
                    "supply over-voltage (Er.002)"},
        FamilyFault{{kSv660c, "100000", "ip"}, "overvoltage", "0x3210", "DC link over voltage"}),
    [](const auto& tested) { return std::string(tested.param.tested.family); });

}  // namespace
}  // namespace cia402
