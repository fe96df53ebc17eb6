// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Warnings at which a drive pauses: it holds the motor and lets it go on by itself once their cause
// is gone. What the joint does is read from the motor.
#include "system/families_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

struct Pausing {
  FamilyMode tested;
  const char* warning;
  const char *code, *words;
};

class FamilyWarning : public testing::TestWithParam<Pausing> {
 protected:
  /// Sends it off, for longer than the test looks. @return at once
  static void sendOff(Scene& scene) {
    const drive::ModeSpec& mode = *scene.state("joint").mode;
    if (mode.kind == ControlKind::velocity) return scene.stream("joint", 0.4, 600ms);
    if (mode.cyclic) {
      EXPECT_TRUE(scene.move({1.8}, 5s).success);
    } else {
      EXPECT_EQ(scene.setpoint("joint", 1.8), "");
    }
    scene.run(1s);
  }
};

TEST_P(FamilyWarning, LetsNothingGoOnByItself) {
  Scene scene(loadText(familyJoint(GetParam().tested)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  sendOff(scene);
  ASSERT_GT(scene.velocity("joint"), 0.2);
  scene.inject("joint", GetParam().warning);
  scene.run(2s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_TRUE(scene.truth("joint").power_stage_on) << "the drive holds it";
  EXPECT_TRUE(scene.state("joint").halted);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr(GetParam().code), HasSubstr(GetParam().words),
                                  HasSubstr("enable releases it")));

  scene.forget();
  scene.inject("joint", "clear");  // its cause is gone, and the drive lets the motor go
  scene.run(2s);
  EXPECT_FALSE(scene.state("joint").warning);
  EXPECT_LT(scene.seen("joint").travel(), 2e-3) << "nobody commanded that";

  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  scene.run(1s);
  EXPECT_LT(scene.seen("joint").travel(), 2e-3) << "nor that";
  const double from = scene.position("joint");
  sendOff(scene);
  EXPECT_GT(scene.position("joint") - from, 0.05) << "it moves again";
}

INSTANTIATE_TEST_SUITE_P(
    ThatPauses, FamilyWarning,
    testing::Values(
        Pausing{{"nimotion_stepper", "4000", "csp"}, "stall", "0x7121", "motor stalled"},
        Pausing{{"nimotion_stepper", "4000", "pp"}, "stall", "0x7121", "motor stalled"},
        Pausing{{"nimotion_stepper", "4000", "pv"}, "stall", "0x7121", "motor stalled"},
        Pausing{{"nimotion_stepper", "4000", "vl"}, "stall", "0x7121", "motor stalled"},
        Pausing{{"nimotion_stepper", "4000", "ip"}, "stall", "0x7121", "motor stalled"},
        Pausing{{"megmeet_dm5", "8388608", "csp"}, "emergency_stop_warning", "0xFF26", "AL.038"},
        Pausing{{"megmeet_dm5", "8388608", "pp"}, "emergency_stop_warning", "0xFF26", "AL.038"}),
    [](const auto& tested) {
      return std::string(tested.param.tested.family) + "_" + tested.param.tested.mode;
    });

// As long as a SYNC period and more; of a DM5 as long as two, with every second of which its code
// comes: without it the bit alone does not tell what the drive does. The code may go before the bit
// does: with a code of 0 a NiMotion would have stopped as at a fault.
TEST_P(FamilyWarning, ThatIsShortHaltsItAndNoMore) {
  const bool dm5 = GetParam().tested.family == std::string("megmeet_dm5");
  for (Duration stands = dm5 ? 9ms : 5ms; stands < 48ms; stands += 2ms) {
    Scene scene(loadText(familyJoint(GetParam().tested)));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
    sendOff(scene);
    scene.inject("joint", GetParam().warning);
    scene.run(stands);
    scene.inject("joint", "clear");
    scene.run(1s);
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << toSeconds(stands) << " s\n" << scene.told();
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << toSeconds(stands) << " s";
    EXPECT_TRUE(scene.state("joint").halted) << toSeconds(stands) << " s";
  }
}

TEST(FamilyWarnings, ThatOnlyTellLetATrajectoryEnd) {
  Scene scene(loadText(familyJoint({"megmeet_dm5", "8388608", "csp"})));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({0.6}, 2s).success);
  scene.run(1s);
  scene.inject("joint", "motor_overload_warning");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 0.6, 1e-4);
  EXPECT_THAT(scene.axis("joint").faultText(),
              HasSubstr("warning 0xFF0C motor overload ahead (AL.012)"));
}

// The same code without bit 7 is the fault.
TEST(FamilyWarnings, OfOneCodeWithAFaultAreToldApart) {
  Scene scene(loadText(familyJoint({"megmeet_dm5", "8388608", "csp"})));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.inject("joint", "motor_overload");
  scene.run(500ms);
  EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("fault 0xFF0C motor overload (Er.012)"));
}

// Bit 7 says of 603Fh that it is the warning's, for as long as that stands: the fault is still the
// one that let the motor go, and its reset waits for nothing but that.
TEST(FamilyWarnings, ThatComeInAFaultDoNotTakeItsName) {
  Scene scene(loadText(familyJoint({"megmeet_dm5", "8388608", "csp"})));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.inject("joint", "overcurrent");
  scene.run(1s);
  scene.inject("joint", "motor_overload_warning");
  scene.run(1s);
  EXPECT_EQ(scene.truth("joint").statusword & 0x0088, 0x0088);
  EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("fault 0xFF01 drive over-current"));
  scene.inject("joint", "clear");
  scene.run(1s);
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x603F, 0})->number, 0xFF01U);
  EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("fault 0xFF01 drive over-current"));
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_TRUE(cleared.success) << cleared.message;
}

}  // namespace
}  // namespace cia402
