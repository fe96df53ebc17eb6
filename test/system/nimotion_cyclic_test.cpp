// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Bit 12 of a NiMotion in its cyclic modes, and bits 4 to 6 in velocity mode while it stops.
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::HasSubstr;

void expectRefusedToEnable(const std::string& yaml) {
  Scene scene(loadText(yaml));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, testing::AllOf(HasSubstr("vl_velocity_max (6046:02)"),
                                              HasSubstr("value of parameter written too high")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

/// A joint whose drive drops its targets, with bit 12 = 0, while an object says so.
std::string droppingJoint(const FamilyMode& tested) {
  return familyJoint(tested,
                     ", simulation: {with: {dictionary: [[0x2FFF, 0, dropped, uint8, rw, -, 0]], "
                     "objects: {targets_dropped: \"2FFF:00\"}}}");
}

class NimotionDropped : public testing::TestWithParam<FamilyMode> {
 protected:
  static void drop(Scene& scene, bool dropped) {
    scene.drive("joint").dictionary().find({0x2FFF, 0})->number = dropped ? 1 : 0;
  }
  static bool bit12(Scene& scene) { return (scene.truth("joint").statusword & 0x1000) != 0; }
  static void lead(Scene& scene, ControlKind kind, Duration time) {
    const Time end = scene.now() + time;
    while (scene.now() < end) {
      (void)scene.setpoint("joint", kind == ControlKind::position ? 1.6 : 0.5);
      scene.run(20ms);
    }
  }
};

// 0: the target is ignored [1503-1514, 1559-1569]; ip the same [1417-1427].
TEST_P(NimotionDropped, TargetsAreToldAndCalledBackToWhereTheMotorStands) {
  FamilyScene scene(droppingJoint(GetParam()));
  scene.run(300ms);
  ASSERT_TRUE(bit12(scene));
  lead(scene, scene.kind(), 700ms);
  ASSERT_GT(scene.velocity("joint"), 0.3);
  drop(scene, true);
  scene.run(8ms);
  ASSERT_FALSE(bit12(scene));
  lead(scene, scene.kind(), 100ms);
  scene.run(600ms);
  EXPECT_THAT(scene.told(), HasSubstr("what was commanded is given up")) << scene.told();
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  drop(scene, false);
  scene.expectStands(1s, 2e-3);
  EXPECT_TRUE(bit12(scene));
  if (scene.kind() == ControlKind::position) {
    const double goal = scene.position("joint") - 0.3;
    EXPECT_EQ(scene.setpoint("joint", goal), "");
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), goal, 1e-3) << scene.told();
  } else {
    scene.stream("joint", -0.4, 800ms);
    EXPECT_NEAR(scene.velocity("joint"), -0.4, 3e-3) << scene.told();
  }
}

// From rest: set-points that run away from a motor that stands would be seen after 0.15 s without
// bit 12, and a velocity never.
TEST_P(NimotionDropped, TargetsAreSeenByTheBitBeforeTheMotorIsMissed) {
  FamilyScene scene(droppingJoint(GetParam()));
  scene.run(300ms);
  ASSERT_TRUE(bit12(scene));
  drop(scene, true);
  scene.run(300ms);
  ASSERT_FALSE(bit12(scene));
  const Time from = scene.now();
  const auto given_up = [&] {
    (void)scene.setpoint("joint", scene.kind() == ControlKind::position ? 0.8 : 0.5);
    return scene.told().find("what was commanded is given up") != std::string::npos;
  };
  EXPECT_TRUE(scene.runUntil(given_up, 1s)) << scene.told();
  EXPECT_LT(toSeconds(scene.now() - from), 0.14);
  EXPECT_NEAR(scene.position("joint"), 0.0, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Nimotion, NimotionDropped,
                         testing::Values(nimotionIn("ip"), nimotionIn("csp"), nimotionIn("csv")),
                         familyModeName);

// csv has no halt bit [1555]: the set-points are ramped to rest.
TEST(NimotionHalt, OfCyclicVelocityDoesWithoutTheHaltBit) {
  FamilyScene scene(
      familyJoint(nimotionIn("csv"), ", simulation: {with: {state_machine: {halt: false}}}"));
  scene.stream("joint", 0.6, 500ms);
  const double from = scene.position("joint");
  scene.mustSucceed(ProcedureKind::halt);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_LT(scene.position("joint") - from, 1.1 * 0.6 * 0.6 / (2.0 * 4.0) + 0.03);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
  scene.expectStands(500ms);
}

// Bit 5 = 0 may lock the ramp of a stop, too: not told [979-993].
TEST(NimotionVelocityMode, StopsAlsoWhereALockedRampWouldHoldTheSpeed) {
  for (const auto kind : {ProcedureKind::quick_stop, ProcedureKind::disable, ProcedureKind::halt}) {
    FamilyScene scene(
        familyJoint(nimotionIn("vl"),
                    ", simulation: {with: {state_machine: {locked_ramp_holds_stops: true}}}"));
    scene.stream("joint", 0.6, 600ms);
    std::uint64_t bits = 0x70;
    scene.watch([&] {
      if (std::fabs(scene.velocity("joint")) > 0.05) bits &= scene.number(0x6040);
    });
    scene.mustSucceed(kind);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << drive::toString(kind);
    EXPECT_EQ(bits, 0x70U) << "while it turned: " << drive::toString(kind);
    scene.watch({});
  }
}

// 6042h and 6046h take 3000/min [2666-2669], of which 16 bits hold far more: 320 rad/s are
// 3056/min.
TEST(NimotionVelocityMode, IsNotEnabledWithALimitThatItsObjectsDoNotTake) {
  const auto yaml = [](const char* velocity) {
    return replaced(
        replaced(replaced(familyJoint(nimotionIn("vl")), "lower: -2.5, upper: 2.5, velocity: 0.8",
                          "lower: -2000.0, upper: 2000.0, " + std::string(velocity)),
                 "gear_ratio: 50.0", "gear_ratio: 1.0"),
        "acceleration: 4.0", "acceleration: 900.0");
  };
  expectRefusedToEnable(yaml("velocity: 320.0"));
  FamilyScene scene(yaml("velocity: 180.0"));
  std::int64_t highest = 0, lowest = 0;
  scene.watch([&] {
    const auto target = static_cast<std::int16_t>(scene.number(0x6042));
    highest = std::max<std::int64_t>(highest, target);
    lowest = std::min<std::int64_t>(lowest, target);
  });
  for (const double way : {1.0, -1.0}) scene.stream("joint", 1000.0 * way, 700ms);
  scene.watch({});
  EXPECT_EQ(highest, 1719) << "180 rad/s";
  EXPECT_EQ(lowest, -1719);
}

}  // namespace
}  // namespace cia402
