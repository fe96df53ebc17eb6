// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Limits of a NiMotion that it holds otherwise than they are written, the one of its
// accelerations (2008h:0C), and those of the product without an encoder.
#include "system/families_motion.h"
#include "system/motion_watch.h"
#include "system/stubborn_object.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// An object in which the drive has another number, and the mode in which it is written.
struct KeptLimit {
  const char* name;
  std::uint16_t index;
  std::uint8_t subindex;
  const char* object;
  const char* mode = "pp";
};
void PrintTo(const KeptLimit& limit, std::ostream* out) { *out << limit.name; }

class NimotionReadBack : public testing::TestWithParam<KeptLimit> {};

TEST_P(NimotionReadBack, OfALimitThatTheDriveHoldsOtherwiseEnablesNothing) {
  const KeptLimit& limit = GetParam();
  Scene scene(loadText(
      familyJoint(nimotionIn(limit.mode), ", write: [{object: acceleration_clamp, raw: 150}]")));
  clamp(scene, limit.index, limit.subindex, 17);
  (void)scene.boot(5s);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(scene.told() + enabled.message,
              AllOf(HasSubstr("the drive took "), HasSubstr(limit.object),
                    testing::AnyOf(HasSubstr("but holds 0x"), HasSubstr("but holds 17"))));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

INSTANTIATE_TEST_SUITE_P(
    All, NimotionReadBack,
    testing::Values(KeptLimit{"RangeMin", 0x607B, 1, "position_range_min"},
                    KeptLimit{"RangeMax", 0x607B, 2, "position_range_max"},
                    KeptLimit{"SoftwareMin", 0x607D, 1, "software_limit_min"},
                    KeptLimit{"SoftwareMax", 0x607D, 2, "software_limit_max"},
                    KeptLimit{"ProfileVelocity", 0x607F, 0, "max_profile_velocity"},
                    KeptLimit{"MotorSpeed", 0x6080, 0, "max_motor_speed"},
                    KeptLimit{"Acceleration", 0x60C5, 0, "max_acceleration"},
                    KeptLimit{"Deceleration", 0x60C6, 0, "max_deceleration"},
                    KeptLimit{"AccelerationClamp", 0x2008, 12, "acceleration_clamp"},
                    KeptLimit{"VelocityModeMin", 0x6046, 1, "vl_velocity_min", "vl"},
                    KeptLimit{"VelocityModeMax", 0x6046, 2, "vl_velocity_max", "vl"}),
    [](const auto& tested) { return std::string(tested.param.name); });

/// rad/s^2 of the joint, over 8 ms.
double hardestOf(const char* mode, const std::string& more) {
  FamilyScene scene(familyJoint(nimotionIn(mode), more));
  Motion motion(scene, "joint");
  if (scene.kind() == ControlKind::position) {
    EXPECT_EQ(scene.setpoint("joint", 0.5), "");
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), 0.5, 1e-3);
  } else {
    scene.stream("joint", 0.6, 600ms);
    scene.run(1s);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  }
  return motion.hardest;
}

// 1/min per ms is 16.6667 turns/s^2 of the motor, 2.0944 rad/s^2 behind the gear of 50, half of
// what the joint has.
TEST(NimotionLimits, OfAccelerationsIsThatOf2008hToo) {
  for (const char* mode : {"pp", "vl", "pv", "csv"}) {
    const double clamped = hardestOf(mode, ", write: [{object: acceleration_clamp, raw: 1}]");
    EXPECT_LT(clamped, 2.0944 * 1.1) << mode;
    EXPECT_GT(clamped, 2.0944 * 0.9) << mode;
    EXPECT_GT(hardestOf(mode, ""), 3.4) << mode;
  }
}

// As the product without an encoder is delivered: 1600 counts a turn, its own ramps, no stall.
TEST(NimotionLoop, OfTheOpenProductIsServedWithItsDefaults) {
  for (const char* mode : {"pp", "pv", "csp"}) {
    std::string yaml = familyJoint(
        nimotionIn(mode),
        ", write: [{object: stall_time, value: 0.1}], simulation: {drive: nimotion_stepper_open}");
    yaml = replaced(yaml, "counts_per_turn: 4000", "counts_per_turn: 1600");
    FamilyScene scene(yaml);
    EXPECT_EQ(scene.number(0x609A), 80000U) << "nothing has written that";
    scene.sendOff();
    scene.inject("joint", "blocked_rotor");
    scene.run(2500ms);
    EXPECT_THAT(scene.told(), Not(HasSubstr("0x7121"))) << mode;
    scene.inject("joint", "clear");
    scene.mustSucceed(ProcedureKind::disable);
    scene.mustSucceed(ProcedureKind::enable);
    const double from = scene.position("joint");
    if (scene.kind() == ControlKind::position) {
      ASSERT_EQ(scene.setpoint("joint", scene.state("joint").position - 0.3), "");
      scene.run(3s);
      EXPECT_NEAR(scene.position("joint") - from, -0.3, 2e-3) << mode << scene.told();
    } else {
      scene.stream("joint", -0.4, 600ms);
      EXPECT_NEAR(scene.velocity("joint"), -0.4, 2e-3) << mode << scene.told();
    }
  }
}

}  // namespace
}  // namespace cia402
