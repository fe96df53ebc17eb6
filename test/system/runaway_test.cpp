// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Motors whose phases are swapped, or whose encoder counts the other way round: whatever is asked
// of them, they turn against it, faster and faster. Judged by the motor.
#include "system/damiao_scene.h"
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::AnyOf;
using testing::HasSubstr;

/// Wrong by more than that it has begun to run away, rad.
constexpr double kBegun = 0.01;
/// 0.03 rad, two windows of 20 ms until it is seen, three until it is seen that the quick stop does
/// not brake, and as many where the drive has to be reset.
constexpr Duration kPatience = 240ms;

struct RunawayScene : FamilyScene {
  explicit RunawayScene(const std::string& yaml) : FamilyScene(yaml) {
    watch([this] {
      const double gone = from - position("joint");
      if (begun == kNever && gone > kBegun) begun = now();
      if (begun != kNever && let_go == kNever && !truth("joint").power_stage_on) let_go = now();
    });
  }
  /// Led upwards for some time, by what the mode takes.
  void lead() {
    from = position("joint");
    const drive::ModeSpec& mode = *state("joint").mode;
    if (mode.kind == ControlKind::position && mode.cyclic) {
      ASSERT_TRUE(move({from + 0.6}, 2s).success);
    } else if (mode.kind == ControlKind::position) {
      ASSERT_EQ(setpoint("joint", from + 0.6), "");
    }
    for (const Time end = now() + 600ms; now() < end; run(4ms)) {
      if (mode.kind != ControlKind::position) (void)setpoint("joint", 0.3);
    }
  }
  double from = 0.0;
  Time begun = kNever, let_go = kNever;
};

void expectLetGo(RunawayScene& scene) {
  ASSERT_NE(scene.begun, kNever) << "it was to run away";
  ASSERT_NE(scene.let_go, kNever) << scene.told();
  EXPECT_LT(scene.let_go - scene.begun, kPatience) << scene.told();
  scene.run(10s);
  EXPECT_FALSE(scene.truth("joint").power_stage_on) << "nothing brings it back by itself";
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << "it has come to rest by friction";
  EXPECT_THAT(scene.told(), AnyOf(HasSubstr("the motor runs away"), HasSubstr("ollowing error")));
  EXPECT_NE(scene.setpoint("joint", 0.1), "");
}

class Runaway : public testing::TestWithParam<FamilyMode> {};

TEST_P(Runaway, IsLetGo) {
  RunawayScene scene(familyJoint(GetParam()));
  scene.inject("joint", "reversed_motor");
  scene.lead();
  expectLetGo(scene);
}

INSTANTIATE_TEST_SUITE_P(All, Runaway,
                         testing::ValuesIn(familyModesThat([](const FamilyMode& mode) {
                           return !isTorqueMode(mode);
                         })),
                         familyModeName);

class DamiaoRunaway : public testing::TestWithParam<const char*> {};

TEST_P(DamiaoRunaway, IsLetGo) {
  RunawayScene scene(damiaoIn(GetParam()));
  scene.inject("joint", "reversed_motor");
  scene.lead();
  expectLetGo(scene);
}

INSTANTIATE_TEST_SUITE_P(In, DamiaoRunaway,
                         testing::Values("cyclic_position", "profile_position", "position_velocity",
                                         "position_velocity_torque", "profile_velocity",
                                         "cyclic_velocity", "velocity_torque"),
                         [](const auto& tested) { return std::string(tested.param); });

// It was well so far: at speed it gets no other chance than at rest.
TEST(RunawayInMotion, IsLetGo) {
  for (const char* mode : {"csp", "pv"}) {
    RunawayScene scene(familyJoint({kMegmeetDm5, "8388608", mode}));
    scene.sendOff(-1.0);
    scene.from = scene.position("joint");
    scene.inject("joint", "reversed_motor");
    scene.run(1s);
    EXPECT_FALSE(scene.truth("joint").power_stage_on) << mode << scene.told();
    scene.run(10s);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << mode;
  }
}

// Nobody commands anything: a disturbance of a count is enough where each correction makes it more.
TEST(RunawayAtRest, IsLetGo) {
  RunawayScene scene(familyJoint({kMegmeetDm5, "8388608", "csp"}));
  scene.run(2s);
  scene.inject("joint", "reversed_motor");
  ASSERT_EQ(scene.setpoint("joint", scene.position("joint") + 1e-3), "");
  scene.run(1s);
  EXPECT_FALSE(scene.truth("joint").power_stage_on) << scene.told();
  scene.run(10s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
}

// A search for home that goes faster than any search.
TEST(RunawaySearch, IsLetGo) {
  RunawayScene scene(
      familyJoint({kMegmeetDm5, "8388608", "csp"},
                  ", homing: {method: 17, search_velocity: 0.3, zero_velocity: 0.05,"
                  " acceleration: 2.0}, simulation: {lower_limit_switch: -0.4}, write: "
                  "[{object: di1_function, raw: 36}]"));
  scene.inject("joint", "reversed_motor");
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, HasSubstr("the motor runs away"));
  scene.run(kPatience);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_FALSE(scene.state("joint").homed);
  scene.run(10s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
}

}  // namespace
}  // namespace cia402
