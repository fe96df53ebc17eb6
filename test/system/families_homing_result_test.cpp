// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How a search for home ends that does not find it, and what an earlier one has left behind.
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

std::string familySearch(const FamilyMode& tested, const char* method, const std::string& switches,
                         const std::string& timeout = "30.0") {
  const bool by_function = tested.family == std::string(kMegmeetDm5);
  const char* told = tested.family == std::string(kNimotionStepper) ? kNimotionSwitches : "";
  return familyJoint(tested, ", homing: {method: " + std::string(method) +
                                 ", search_velocity: 0.4, zero_velocity: 0.05, acceleration: 2.0,"
                                 " timeout: " +
                                 timeout + "}, simulation: {" + switches + "}" +
                                 (by_function ? ", write: [{object: di1_function, raw: 36},"
                                                " {object: di2_function, raw: 32},"
                                                " {object: di3_function, raw: 35}]"
                                              : told));
}

class FamilyHomingResult : public testing::TestWithParam<FamilyMode> {
 protected:
  static void expectNotHomed(Scene& scene) {
    scene.run(500ms);
    EXPECT_FALSE(scene.state("joint").homed);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
    scene.forget();
    scene.run(1s);
    EXPECT_LT(scene.seen("joint").travel(), 1e-4) << scene.told();
  }
  /// It stands, also as its halt is released.
  static void expectHeldAndReleased(Scene& scene) {
    scene.forget();
    scene.run(500ms);
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "joint");
    EXPECT_TRUE(enabled.success) << enabled.message;
    scene.run(1s);
    EXPECT_LT(scene.seen("joint").travel(), 1e-4) << scene.told();
  }
};

TEST_P(FamilyHomingResult, IsAnInterruptionWhereItIsHaltedAndTheAxisHolds) {
  Scene scene(loadText(familySearch(GetParam(), "17", "lower_limit_switch: -2.0")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto homed = scene.begin(ProcedureKind::home, "joint");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") < -0.35; }, 8s)) << scene.told();
  const double from = scene.position("joint");
  EXPECT_TRUE(scene.procedure(ProcedureKind::halt, "joint").success);
  EXPECT_GT(scene.position("joint") - from, -0.4 * 0.06 - 1.1 * 0.4 * 0.4 / (2.0 * 2.0));
  ASSERT_TRUE(scene.runUntil([&] { return homed->has_value(); }, 3s));
  EXPECT_FALSE((*homed)->success);
  EXPECT_THAT((*homed)->message, AllOf(HasSubstr("joint (node 1)"), HasSubstr("halt")));
  expectNotHomed(scene);
  EXPECT_TRUE(scene.truth("joint").power_stage_on) << "it is halted, not switched off";
}

// Its halt bit would keep the drive from searching: it ends with the call.
TEST_P(FamilyHomingResult, FindsHomeAfterAHaltOfTheSearchBefore) {
  Scene scene(loadText(familySearch(GetParam(), "17", "lower_limit_switch: -0.8")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto homed = scene.begin(ProcedureKind::home, "joint");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") < -0.35; }, 8s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt, "joint").success);
  ASSERT_TRUE(scene.runUntil([&] { return homed->has_value(); }, 3s));
  ASSERT_TRUE(scene.state("joint").halted);
  const bus::Answer again = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_TRUE(again.success) << again.message;
  EXPECT_NEAR(scene.position("joint"), -0.8, 0.05);
  expectHeldAndReleased(scene);
}

TEST_P(FamilyHomingResult, IsFoundByAnAxisThatWasHaltedOnItsWayToAGoal) {
  FamilyMode goals = GetParam();
  goals.mode = "pp";
  Scene scene(loadText(replaced(familySearch(goals, "17", "lower_limit_switch: -0.8"), "homing: {",
                                "homing: {required: false, ")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  ASSERT_EQ(scene.setpoint("joint", 1.4), "");
  scene.run(600ms);
  ASSERT_GT(scene.velocity("joint"), 0.3);
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt, "joint").success);
  scene.forget();
  const double halted = scene.position("joint");
  const bus::Answer answer = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_LT(scene.seen("joint").highest, halted + 1e-3) << "it does not go on to its goal";
  EXPECT_NEAR(scene.position("joint"), -0.8, 0.05);
  expectHeldAndReleased(scene);
}

// Efforts that end leave the axis halted by the mode that braked it. The motor has just set off,
// which the feedback of then does not show yet: it is braked before its power goes.
TEST(FamilyHomingResults, AreNoneWhereItIsDisabledAsItSetsOffFromAHalt) {
  for (const FamilyMode& tested :
       {FamilyMode{kId286Cnfa, "10000", "pt"}, FamilyMode{kMegmeetDm5, "8388608", "pt"}}) {
    for (const double begun : {0.001, 0.03, 0.1}) {
      Scene scene(loadText(replaced(familySearch(tested, "17", "lower_limit_switch: -2.0"),
                                    "sync_period: 0.004", "sync_period: 0.01")));
      ASSERT_TRUE(scene.boot(20s)) << scene.told();
      ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
      scene.stream("joint", 5.0, 400ms);
      scene.run(2s);
      ASSERT_TRUE(scene.state("joint").halted) << scene.told();
      double when_off = 0.0;
      bool on = true;
      scene.watch([&] {
        const bool power = scene.truth("joint").power_stage_on;
        if (on && !power) when_off = std::max(when_off, std::fabs(scene.velocity("joint")));
        on = power;
      });
      const auto homed = scene.begin(ProcedureKind::home, "joint");
      ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") < -begun; }, 8s))
          << tested.family << scene.told();
      EXPECT_TRUE(scene.procedure(ProcedureKind::disable, "joint").success);
      EXPECT_LT(when_off, 0.01) << tested.family << " at " << begun << " rad/s";
      EXPECT_FALSE(scene.truth("joint").power_stage_on);
    }
  }
}

TEST_P(FamilyHomingResult, IsTheTimeOutOfTheDriverWhichStopsIt) {
  Scene scene(loadText(familySearch(GetParam(), "17", "lower_limit_switch: -2.0", "1.5")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  // The DM5 has a time of its own, P12.09, which would be over first.
  sim::Entry* own = scene.drive("joint").dictionary().find({0x200C, 10});
  if (own != nullptr && GetParam().family == std::string(kMegmeetDm5)) own->number = 60000;
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message,
              AllOf(HasSubstr("joint (node 1): homing timed out after 1.5 s"),
                    HasSubstr("method 17"), HasSubstr("The drive was still searching")));
  expectNotHomed(scene);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_GT(scene.position("joint"), -1.0);
}

// The switch is somewhere else when it searches again.
TEST_P(FamilyHomingResult, IsNotThatOfAnEarlierSearch) {
  Scene scene(loadText(familySearch(GetParam(), "17", "lower_limit_switch: -0.4")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message;
  ASSERT_NEAR(scene.position("joint"), -0.4, 0.02);
  EXPECT_NEAR(scene.state("joint").position, scene.position("joint") + 0.4, 2e-3);
  scene.drive("joint").mechanics().negative_limit_switch = -0.9 * 50.0 / 6.283185307179586;
  homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message;
  EXPECT_NEAR(scene.position("joint"), -0.9, 0.02);
  EXPECT_NEAR(scene.state("joint").position, scene.position("joint") + 0.9, 2e-3);
}

// The limit switch is there before the home switch: method 21 knows no turning.
TEST_P(FamilyHomingResult, IsAnErrorInWordsWhereTheDriveMeetsAWrongSwitch) {
  Scene scene(loadText(familySearch(GetParam(), "21",
                                    "initial_position: 0.0, home_switch: [-1.6, "
                                    "-1.4], lower_limit_switch: -0.5, upper_limit_switch: 2.0")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, AllOf(HasSubstr("joint (node 1)"), HasSubstr("homing")));
  EXPECT_GT(scene.position("joint"), -0.5 - 0.1);
  expectNotHomed(scene);
}

TEST_P(FamilyHomingResult, IsAFaultInWordsWhereOneComesMeanwhile) {
  Scene scene(loadText(familySearch(GetParam(), "17", "lower_limit_switch: -2.0")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto homed = scene.begin(ProcedureKind::home, "joint");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") < -0.35; }, 8s)) << scene.told();
  const bool dm5 = GetParam().family == std::string(kMegmeetDm5);
  const bool one_word = GetParam().family == std::string("generic_cia402") ||
                        GetParam().family == std::string(kSv660c);
  scene.inject("joint", dm5 ? "homing_time" : one_word ? "overvoltage" : "over_voltage");
  ASSERT_TRUE(scene.runUntil([&] { return homed->has_value(); }, 3s));
  EXPECT_FALSE((*homed)->success);
  EXPECT_THAT((*homed)->message, HasSubstr("joint (node 1): fault"));
  scene.run(100ms);
  EXPECT_THAT(scene.axis("joint").faultText(),
              HasSubstr(dm5 ? "0xFF25 homing took too long (Er.037)" : "voltage"));
  scene.run(2s);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_FALSE(scene.state("joint").homed);
}

INSTANTIATE_TEST_SUITE_P(All, FamilyHomingResult, testing::ValuesIn(families()), familyName);
INSTANTIATE_TEST_SUITE_P(Generic, FamilyHomingResult,
                         testing::Values(FamilyMode{"generic_cia402", "131072", "csp"}),
                         familyName);

}  // namespace
}  // namespace cia402
