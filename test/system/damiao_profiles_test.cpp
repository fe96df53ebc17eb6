// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Trapezoids and S-curves of a Damiao (6086h), by the motor; and statusword bit 9.
#include "system/damiao_scene.h"
#include "system/families_motion.h"
#include "system/motion_watch.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr char kCurve[] = ", write: [{object: motion_profile_type, raw: 1}]";

/// The greatest change of acceleration of the joint over 20 ms, rad/s^3, on its way to a place or a
/// speed.
double damiaoJerk(FamilyScene& scene) {
  std::vector<double> speeds;
  scene.watch([&] { speeds.push_back(scene.velocity("joint")); });
  if (scene.kind() == ControlKind::position) {
    EXPECT_EQ(scene.setpoint("joint", -0.6), "");
    scene.run(2500ms);
    EXPECT_NEAR(scene.position("joint"), -0.6, 1e-3) << scene.told();
  } else {
    scene.stream("joint", -1.6, 700ms);
    EXPECT_NEAR(scene.velocity("joint"), -1.6, 0.01) << scene.told();
  }
  scene.watch({});
  return greatestJerk(speeds);
}

/// The mode alone, with S-curves.
std::string curvedIn(const std::string& mode) {
  return damiaoIn(mode, kCurve + (", modes: [" + mode + "]"));
}

/// The modes whose ramps are the drive's: positions and velocities.
class DamiaoCurve : public testing::TestWithParam<const char*> {};

// 15 rad/s^2 within 0.1 s are 150 rad/s^3; a trapezoid has them within one control loop, and is
// 15 / 0.02 = 750 rad/s^3 over 20 ms.
TEST_P(DamiaoCurve, IsATrapezoidOrAnSAsTheFileSays) {
  FamilyScene trapezoid(damiaoIn(GetParam()));
  EXPECT_GT(damiaoJerk(trapezoid), 450.0);
  TracedScene boot(curvedIn(GetParam()));
  ASSERT_TRUE(boot.boot()) << boot.told();
  EXPECT_THAT(boot.writes(4), Contains("23 86 60 00 01 00 00 00"));
  FamilyScene curve(curvedIn(GetParam()));
  EXPECT_LT(damiaoJerk(curve), 150.0 * 1.2);
  const bus::Answer stopped = curve.procedure(ProcedureKind::quick_stop);
  EXPECT_TRUE(stopped.success) << stopped.message;
  EXPECT_NEAR(curve.velocity("joint"), 0.0, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(All, DamiaoCurve,
                         testing::Values("profile_position", "position_velocity",
                                         "position_velocity_torque", "profile_velocity",
                                         "velocity_torque"),
                         [](const auto& tested) { return std::string(tested.param); });

// "Torque mode has trapezoids alone" [L10].
TEST(DamiaoCurves, AreRefusedWhereTorqueModeIsOneOfTheAxis) {
  Scene scene(
      loadText(damiaoIn("cyclic_position", std::string(kCurve) + ", modes: [cyclic_position, "
                                                                 "profile_torque]")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer refused = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("motion_profile_type (6086:00) is 1"),
                                     HasSubstr("torque mode has no S-curve")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

TEST(DamiaoCurves, OfOtherNumbersAreRefusedBeforeAnythingIsSent) {
  TracedScene scene(damiaoIn("profile_position"));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.clear();
  const auto written = call(scene, bus::WriteObjectCommand{"joint", "motion_profile_type", "3"});
  EXPECT_FALSE(written.success);
  EXPECT_EQ(scene.count("604 23 86 60"), 0U) << written.message;
  EXPECT_EQ(numberIn(scene, 0x6086), 0U);
}

constexpr char kDamiaoBit9[] = "statusword bit 9 is 0, it is not under the control of CANopen";

std::string damiaoLocal(const char* from, const char* until) {
  return damiaoIn("profile_position", "",
                  "quirks: {local_from: " + std::string(from) + ", local_until: " + until + "}");
}

TEST(DamiaoRemote, NothingIsEnabledWhileBit9Is0) {
  TracedScene scene(damiaoLocal("0.0", "6.0"));
  ASSERT_TRUE(scene.boot(5s)) << scene.told();
  scene.clear();
  const bus::Answer refused = scene.procedure(ProcedureKind::enable, "joint");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message,
              AllOf(HasSubstr("joint (node 4): is not enabled: "), HasSubstr(kDamiaoBit9)));
  EXPECT_EQ(scene.count("204 06"), 0U);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  ASSERT_TRUE(scene.runUntil([&] { return scene.now() >= Time{6100ms}; }, 7s));
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "joint");
  EXPECT_TRUE(enabled.success) << enabled.message;
}

TEST(DamiaoRemote, NoSetPointIsTakenOnceBit9Falls) {
  Scene scene(loadText(damiaoLocal("5.0", "6.5")));
  ASSERT_TRUE(scene.boot(4s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  ASSERT_EQ(scene.setpoint("joint", 0.9), "");
  ASSERT_TRUE(scene.runUntil([&] { return scene.now() >= Time{5100ms}; }, 6s));
  scene.forget();
  EXPECT_THAT(scene.setpoint("joint", 0.2), HasSubstr(kDamiaoBit9));
  scene.run(1s);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4) << scene.told();
  scene.run(600ms);
  EXPECT_EQ(scene.setpoint("joint", 0.2), "");
  scene.run(2s);
  EXPECT_NEAR(scene.position("joint"), 0.2, 1e-3);
}

}  // namespace
}  // namespace cia402
