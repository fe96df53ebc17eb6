// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Each transition of CiA 402 by its word on the wire, by PDO and by SDO, and what follows where the
// drive does not make it. What the motor does is read from the motor.
#include "system/damiao_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string wayOut(const std::string& way) { return ", disable_by: [" + way + "]"; }

class FamilyTransitions : public testing::TestWithParam<FamilyMode> {
 protected:
  /// A fault of the power stage, as the simulated drives call it, and how its code begins.
  static const char* overCurrent() {
    return is(GetParam(), kBusNimotion) || is(GetParam(), kBusId286) ? "over_current"
                                                                     : "overcurrent";
  }
  static const char* overCurrentCode() { return is(GetParam(), kBusId286) ? "0x000A" : "0x2"; }
  static void expectOff(Scene& scene) {
    scene.run(200ms);
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
    EXPECT_LT(scene.seen("joint").travel(), 1e-4) << scene.told();
  }
};

INSTANTIATE_TEST_SUITE_P(Of, FamilyTransitions, allFamilies(), nameOfFamily);

// 2, 3 and 4; 5 and 10, 5, 6 and 7, 8 and 7, or 9, each after its state.
TEST_P(FamilyTransitions, GoByTheirWordsInThePdo) {
  struct Way {
    const char* transitions;
    std::vector<std::string> words;
  };
  for (const Way& way :
       {Way{"5, 10", {"07@27", "00@23"}}, Way{"5, 6, 7", {"07@27", "06@23", "00@21"}},
        Way{"8, 7", {"06@27", "00@21"}}, Way{"9", {"00@27"}}}) {
    TracedScene scene(busJoint(GetParam(), wayOut(way.transitions)));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    scene.run(100ms);
    scene.clear();
    scene.forget();
    ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
    std::vector<std::string> enabling = {"06@40", "07@21", "0F@23"};
    if (is(GetParam(), kBusSv660c)) enabling.push_back("1F@27");  // ip wants bit 4 [L920]
    EXPECT_THAT(commandsSeen(scene, 1), testing::ElementsAreArray(enabling));
    EXPECT_TRUE(scene.truth("joint").power_stage_on);
    scene.run(200ms);
    scene.clear();
    const bus::Answer disabled = scene.procedure(ProcedureKind::disable);
    EXPECT_TRUE(disabled.success) << disabled.message;
    EXPECT_THAT(commandsSeen(scene, 1), testing::ElementsAreArray(way.words)) << way.transitions;
    expectOff(scene);
  }
}

// 11 by its word, 12 by the drive itself; from a motion `disable` goes that way, too.
TEST_P(FamilyTransitions, OutOfAMotionBeginWithAQuickStop) {
  for (const ProcedureKind kind : {ProcedureKind::quick_stop, ProcedureKind::disable}) {
    TracedScene scene(busJoint(GetParam(), wayOut("8, 7")));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
    ASSERT_EQ(scene.setpoint("joint", scene.state("joint").position + 2.0), "");
    scene.run(1s);
    ASSERT_GT(scene.velocity("joint"), 0.5);
    scene.clear();
    EXPECT_TRUE(scene.procedure(kind).success);
    const std::vector<std::string> seen = commandsSeen(scene, 1);
    ASSERT_FALSE(seen.empty());
    EXPECT_EQ(seen.front(), "02@27");
    scene.forget();
    expectOff(scene);
  }
}

// 15 is an edge of bit 7. All by SDO, where the axis has no PDOs.
TEST_P(FamilyTransitions, GoByTheirWordsBySdo) {
  FamilyMode tested = GetParam();
  if (is(tested, kBusSv660c)) tested.mode = "profile_position";  // its ip takes no SDO
  TracedScene scene(busJoint(tested, wayOut("5, 6, 7") + ", pdos: none"));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.run(200ms);
  const auto word = [](const char* low) { return "2B 40 60 00 " + std::string(low) + " 00 00 00"; };
  scene.clear();
  scene.forget();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  EXPECT_TRUE(inOrder(scene.writes(), {word("06"), word("07"), word("0F")}));
  scene.run(200ms);
  scene.clear();
  EXPECT_TRUE(scene.procedure(ProcedureKind::disable).success);
  EXPECT_TRUE(inOrder(scene.writes(), {word("07"), word("06"), word("00")}));
  expectOff(scene);
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  scene.inject("joint", overCurrent());
  scene.run(500ms);
  scene.clear();
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_TRUE(cleared.success) << cleared.message;
  EXPECT_TRUE(inOrder(scene.writes(), {word("80"), word("00")}));
  expectOff(scene);
}

/// A transition that the drive does not make, what is asked for, and what is said.
struct NotMade {
  int transition;
  const char* way;
  const char* told;
};

// timing/state_change of the profiles: 2 s each.
TEST_P(FamilyTransitions, ThatAreNotMadeInTimeAreTold) {
  for (const NotMade& row : {NotMade{2, "5, 10", "in switch on disabled for 2"},
                             NotMade{3, "5, 10", "in ready to switch on for 2"},
                             NotMade{4, "5, 10", "in switched on for 2"}}) {
    Scene scene(
        loadText(busJoint(GetParam(), ", simulation: {with: {quirks: {refused_transitions: [" +
                                          std::to_string(row.transition) + "]}}}")));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    scene.forget();
    const Time asked = scene.now();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    EXPECT_FALSE(enabled.success) << row.transition;
    EXPECT_LT(scene.now() - asked, 5s) << row.transition;
    EXPECT_THAT(enabled.message,
                AllOf(HasSubstr("joint (node 1): enabling timed out"), HasSubstr(row.told)));
    expectOff(scene);
  }
}

TEST_P(FamilyTransitions, OutOfOperationThatAreNotMadeInTimeAreTold) {
  // A DM5 may close its brake first, which P02.11 and P02.13 say; an SV660C has 5 s for its ramp
  // (timing/transitions), and 2 s for each transition behind that.
  const Duration longest = is(GetParam(), kBusDm5) ? 12s : is(GetParam(), kBusSv660c) ? 10s : 7s;
  for (const NotMade& row :
       {NotMade{5, "5, 10", "operation enabled"}, NotMade{10, "5, 10", "switched on"},
        NotMade{6, "5, 6, 7", "switched on"}, NotMade{7, "5, 6, 7", "ready to switch on"},
        NotMade{8, "8, 7", "operation enabled"}, NotMade{9, "9", "operation enabled"}}) {
    Scene scene(loadText(busJoint(
        GetParam(), wayOut(row.way) + ", simulation: {with: {quirks: {refused_transitions: [" +
                        std::to_string(row.transition) + "]}}}")));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
    scene.run(200ms);
    scene.forget();
    const Time asked = scene.now();
    const bus::Answer disabled = scene.procedure(ProcedureKind::disable);
    EXPECT_FALSE(disabled.success) << row.transition;
    EXPECT_LT(scene.now() - asked, longest) << row.transition;
    EXPECT_THAT(disabled.message, AllOf(HasSubstr("joint (node 1): disabling timed out after "),
                                        HasSubstr(row.told)));
    EXPECT_LT(scene.seen("joint").travel(), 1e-4) << "it stands all the same";
  }
}

// 11: the motor is stopped by set-points all the same. 12: the drive stays in quick stop active.
// 15: the fault stays.
TEST_P(FamilyTransitions, OfStopsAndResetsThatAreNotMadeInTimeAreTold) {
  const auto with = [](const std::string& keys) { return ", simulation: {with: {" + keys + "}}"; };
  const std::string held = with(
      "quirks: {refused_transitions: [12]}, state_machine: {quick_stop: {default: 2, values: {1: "
      "{ramp: slow_down, hold: true}, 2: {ramp: quick_stop, hold: true}}}}");
  for (const std::string& more : {with("quirks: {refused_transitions: [11]}"), held}) {
    Scene scene(loadText(busJoint(GetParam(), more)));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
    scene.forget();
    const Time asked = scene.now();
    const bus::Answer stopped = scene.procedure(ProcedureKind::quick_stop);
    EXPECT_LT(scene.now() - asked, 8s);
    EXPECT_THAT(stopped.message,
                HasSubstr(more == held ? "quick stop active" : "operation enabled"))
        << scene.told();
    EXPECT_LT(scene.seen("joint").travel(), 1e-4);
  }
  Scene scene(loadText(busJoint(GetParam(), with("quirks: {fault_reset_tries: 20}"))));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.inject("joint", overCurrent());
  scene.run(500ms);
  const Time asked = scene.now();
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_FALSE(cleared.success);
  EXPECT_LT(scene.now() - asked, 15s);
  EXPECT_THAT(cleared.message, HasSubstr(overCurrentCode()));
}

}  // namespace
}  // namespace cia402
