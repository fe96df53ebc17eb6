// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every alarm of each family: what people read of it, and how it ends. One robot has them one after
// the other.
#include "system/families_faults.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::HasSubstr;

struct FamilyAlarms {
  FamilyMode tested;
  std::vector<FamilyAlarm> faults;
};
void PrintTo(const FamilyAlarms& alarms, std::ostream* out) { *out << alarms.tested.family; }

class FamilyFaults : public testing::TestWithParam<FamilyAlarms> {
 protected:
  static void expectTold(FamilyScene& scene, const FamilyAlarm& alarm) {
    EXPECT_EQ(scene.state("joint").state, State::fault) << alarm.name;
    EXPECT_FALSE(scene.truth("joint").power_stage_on) << alarm.name;
    EXPECT_THAT(scene.axis("joint").faultText(),
                AllOf(HasSubstr("joint (node 1): fault " + std::string(alarm.code) + " "),
                      HasSubstr(alarm.words)))
        << alarm.name;
    EXPECT_EQ(scene.number(0x603F), std::stoul(alarm.code, nullptr, 16)) << alarm.name;
  }
  /// Until its cause is gone, whatever it takes.
  static void expectEnds(FamilyScene& scene, const FamilyAlarm& alarm) {
    const auto clear = [&] { return scene.procedure(ProcedureKind::clear_faults, "joint"); };
    if (alarm.ends == Ends::after_a_minute) {
      const bus::Answer early = clear();
      EXPECT_FALSE(early.success) << alarm.name;
      EXPECT_THAT(early.message, AllOf(HasSubstr("takes no reset of it for 60 s: call again in "),
                                       HasSubstr(alarm.code)));
      scene.run(60s);
    } else {
      scene.run(2s);
    }
    if (alarm.ends == Ends::by_power_cycle) {
      EXPECT_FALSE(clear().success) << alarm.name;
      EXPECT_EQ(scene.state("joint").state, State::fault) << alarm.name;
      scene.inject("joint", "power_cycle");
      scene.run(8s);
    }
    const bus::Answer cleared = clear();
    EXPECT_TRUE(cleared.success) << alarm.name << ": " << cleared.message;
    EXPECT_EQ(scene.state("joint").state, State::switch_on_disabled) << alarm.name;
    EXPECT_EQ(scene.axis("joint").faultText(), "") << alarm.name;
  }
};

TEST_P(FamilyFaults, AreAllThatTheSimulatedDriveHas) {
  std::set<std::string> listed;
  for (const FamilyAlarm& alarm : GetParam().faults) listed.insert(alarm.name);
  EXPECT_EQ(alarmNames(*familyDefinition(GetParam().tested.family), false), listed);
}

TEST_P(FamilyFaults, AreToldByCodeAndWordsAndEndAsTheManualSays) {
  FamilyScene scene(familyJoint(GetParam().tested));
  for (const FamilyAlarm& alarm : GetParam().faults) {
    scene.inject("joint", alarm.name);
    scene.run(50ms);
    expectTold(scene, alarm);
    scene.forget();
    expectEnds(scene, alarm);
    scene.run(100ms);
    EXPECT_LT(scene.seen("joint").travel(), 1e-4) << alarm.name;
    EXPECT_FALSE(scene.truth("joint").power_stage_on) << alarm.name << ": it waits for `enable`";
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "joint");
    ASSERT_TRUE(enabled.success) << alarm.name << ": " << enabled.message;
  }
}

// 0x1234 is in no manual.
TEST_P(FamilyFaults, OfACodeThatNoManualHasAreToldAsItsNumber) {
  FamilyScene scene(familyJoint(GetParam().tested));
  scene.inject("joint", "0x1234");
  scene.run(50ms);
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr("joint (node 1): fault 0x1234 "),
                    HasSubstr("the drive's manual says more about this code")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  scene.mustSucceed(ProcedureKind::clear_faults);
}

TEST_P(FamilyFaults, WhoseCauseStaysAreRefusedInWordsAndClearedLater) {
  for (const char* name : {"under_voltage", "undervoltage"}) {
    const auto definition = familyDefinition(GetParam().tested.family);
    const sim::FaultDefinition* known = definition->fault(name);
    if (known == nullptr) continue;
    FamilyScene scene(familyJoint(
        GetParam().tested, ", simulation: {with: {faults: {" + std::string(name) +
                               ": {code: " + std::to_string(known->code) +
                               ", voltage_lost: true, reaction: coast, persists_for: 6.0}}}}"));
    scene.sendOff();
    scene.inject("joint", name);
    scene.run(100ms);
    const bus::Answer refused = scene.procedure(ProcedureKind::clear_faults, "joint");
    EXPECT_FALSE(refused.success);
    EXPECT_THAT(refused.message,
                AllOf(HasSubstr("joint (node 1): fault 0x"), HasSubstr("voltage")));
    EXPECT_FALSE(scene.procedure(ProcedureKind::enable, "joint").success);
    scene.run(6s);
    scene.forget();
    const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults, "joint");
    EXPECT_TRUE(cleared.success) << cleared.message;
    scene.run(500ms);
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(500ms);
  }
}

/// The edges of controlword bit 7 that a drive sees while its fault is cleared.
unsigned resetEdges(Scene& scene) {
  unsigned edges = 0;
  bool high = false;
  scene.watch([&] {
    const auto word = scene.drive("joint").dictionary().find({0x6040, 0})->number;
    const bool now = (word & 0x80) != 0;
    if (now && !high) ++edges;
    high = now;
  });
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults, "joint");
  EXPECT_TRUE(cleared.success) << cleared.message;
  scene.run(100ms);
  EXPECT_FALSE(high) << "it is taken back";
  scene.watch({});
  return edges;
}

TEST_P(FamilyFaults, AreResetByOneEdgeOfBit7AlsoTheNextTime) {
  FamilyScene scene(familyJoint(GetParam().tested));
  for (int i = 0; i < 2; ++i) {
    scene.inject("joint", GetParam().faults.front().name);
    scene.run(500ms);
    EXPECT_EQ(resetEdges(scene), 1U);
    scene.mustSucceed(ProcedureKind::enable);
  }
}

// Its manual has no table of codes: those of CiA 402 are taken, and one that nobody knows.
TEST(DamiaoAlarms, AreToldByTheirCodesAndResetByOneEdgeOfBit7) {
  FamilyScene scene(damiaoJoint());
  for (const auto& [name, code] :
       {std::pair("overcurrent", "0x2310"), std::pair("overvoltage", "0x3210"),
        std::pair("undervoltage", "0x3220"), std::pair("overtemperature", "0x4210"),
        std::pair("motor_overtemperature", "0x4310"), std::pair("encoder", "0x7305"),
        std::pair("following_error", "0x8611"), std::pair("0x1234", "0x1234")}) {
    scene.inject("joint", name);
    scene.run(1500ms);
    EXPECT_FALSE(scene.truth("joint").power_stage_on) << name;
    EXPECT_THAT(scene.axis("joint").faultText(),
                HasSubstr("joint (node 4): fault " + std::string(code) + " "));
    EXPECT_EQ(resetEdges(scene), 1U) << name;
    EXPECT_FALSE(scene.truth("joint").power_stage_on) << name;
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(200ms);
  }
}

/// In motion: nothing streams on, and clearing brings nothing back.
TEST_P(FamilyFaults, InMotionEndItAndBringNothingBack) {
  FamilyScene scene(familyJoint(GetParam().tested));
  scene.sendOff();
  scene.inject("joint", GetParam().faults.front().name);
  scene.run(3s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_THAT(scene.setpoint("joint", 0.2), HasSubstr(GetParam().faults.front().code));
  scene.forget();
  scene.mustSucceed(ProcedureKind::clear_faults);
  scene.run(500ms);
  scene.mustSucceed(ProcedureKind::enable);
  scene.run(500ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4);
  scene.sendOff();
}

INSTANTIATE_TEST_SUITE_P(
    All, FamilyFaults,
    testing::Values(FamilyAlarms{{kNimotionStepper, "4000", "csp"}, nimotionFaults()},
                    FamilyAlarms{{kId286Cnfa, "10000", "pp"}, id286Faults()},
                    FamilyAlarms{{kMegmeetDm5, "8388608", "csp"}, dm5Faults()},
                    FamilyAlarms{{kSv660c, "100000", "ip"}, sv660cFaults()}),
    [](const auto& tested) { return std::string(tested.param.tested.family); });

/// A blocked rotor, in each mode of positions.
class FamilyFollowing : public testing::TestWithParam<FamilyMode> {};

TEST_P(FamilyFollowing, ErrorsAreToldAndLeadToNoLeap) {
  const FamilyMode& tested = GetParam();
  const bool wide = tested.family == std::string(kMegmeetDm5);  // 2.84 turns of the motor
  FamilyScene scene(
      familyJoint(tested, wide ? ", write: [{object: following_error_window, value: 0.05}]" : ""));
  scene.sendOff();
  scene.inject("joint", "blocked_rotor");
  scene.run(200ms);
  const double held = scene.position("joint");
  scene.run(4s);
  const bool faults = tested.family != std::string(kNimotionStepper);
  if (faults) {
    EXPECT_EQ(scene.state("joint").state, State::fault) << scene.told();
    EXPECT_THAT(scene.axis("joint").faultText(),
                HasSubstr(tested.family == std::string(kId286Cnfa) ? "0x0019 following error"
                                                                   : "0xFF20 position error"));
  } else {
    EXPECT_THAT(scene.told(), HasSubstr("joint (node 1)")) << scene.told();
    EXPECT_THAT(scene.told(), HasSubstr("stand")) << scene.told();
  }
  scene.forget();
  scene.inject("joint", "clear");
  scene.run(2s);
  EXPECT_LT(std::fabs(scene.position("joint") - held), 0.02) << scene.told();
  EXPECT_LT(scene.seen("joint").fastest, 0.3) << "no leap";
}

class FamilyLag : public testing::TestWithParam<FamilyMode> {};

// A motor that lags 20 ms behind is 16 mrad behind 0.8 rad/s.
TEST_P(FamilyLag, IsToldAsTheFollowingErrorByWhichItIsBehind) {
  FamilyScene scene(familyJoint(GetParam(), ", simulation: {time_constant: 0.02}"));
  ASSERT_EQ(scene.setpoint("joint", 2.2), "");
  scene.run(1s);
  for (int i = 0; i < 5; ++i) {
    scene.axis("joint").look();
    scene.run(100ms);
  }
  ASSERT_NEAR(scene.velocity("joint"), 0.8, 0.01);
  EXPECT_NEAR(scene.state("joint").following_error, 0.016, 1e-3);
  scene.run(3s);
  scene.axis("joint").look();
  scene.run(300ms);
  EXPECT_NEAR(scene.state("joint").following_error, 0.0, 1.1 * oneCount(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(All, FamilyLag,
                         testing::Values(FamilyMode{kNimotionStepper, "4000", "csp"},
                                         FamilyMode{kNimotionStepper, "4000", "pp"},
                                         FamilyMode{kMegmeetDm5, "8388608", "csp"},
                                         FamilyMode{kMegmeetDm5, "8388608", "pp"}),
                         familyModeName);

INSTANTIATE_TEST_SUITE_P(All, FamilyFollowing,
                         testing::Values(FamilyMode{kNimotionStepper, "4000", "pp"},
                                         FamilyMode{kNimotionStepper, "4000", "ip"},
                                         FamilyMode{kNimotionStepper, "4000", "csp"},
                                         FamilyMode{kId286Cnfa, "10000", "pp"},
                                         FamilyMode{kMegmeetDm5, "8388608", "pp"},
                                         FamilyMode{kMegmeetDm5, "8388608", "csp"}),
                         familyModeName);

}  // namespace
}  // namespace cia402
