// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Each value of the option codes of an SV660C stops the motor as its page says [L15012-15153], and
// is told in words.
#include <cmath>

#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::HasSubstr;

/// How the motor comes to rest from 1.5 rad/s.
enum class Sv660cWay {
  gentle,  ///< 6084h, 4 rad/s^2: 0.281 rad
  quick,   ///< 6085h, 8 rad/s^2: 0.141 rad
  hard,    ///< 100 N m are 0.837 of the rated torque, 105 rad/s^2: 0.011 rad
  brake,   ///< shorted windings, 330 turns/s^2 of the motor, 41.5 rad/s^2; without power at once
  coasts,  ///< friction and what goes with the speed, 3.8 to 4.5 rad/s^2; without power at once
};

struct Sv660cOption {
  const char* object;
  int value;
  Sv660cWay way;
  bool holds;         ///< under power, afterwards
  const char* words;  ///< of read_object
};

constexpr double kSv660cSpeed = 1.5;

double sv660cWayOf(Sv660cWay way) {
  switch (way) {
    case Sv660cWay::gentle:
      return kSv660cSpeed * kSv660cSpeed / 2.0 / 4.0;
    case Sv660cWay::quick:
      return kSv660cSpeed * kSv660cSpeed / 2.0 / 8.0;
    case Sv660cWay::hard:
      return kSv660cSpeed * kSv660cSpeed / 2.0 / 105.0;
    case Sv660cWay::brake:
      return kSv660cSpeed * kSv660cSpeed / 2.0 / 41.5;
    case Sv660cWay::coasts:
      break;
  }
  return kSv660cSpeed * kSv660cSpeed / 2.0 / 4.1;
}

class Sv660cOptions : public testing::TestWithParam<Sv660cOption> {
 protected:
  /// Moves off at full speed, with the option in the drive.
  void begin(Scene& scene) {
    ASSERT_THAT(sv660cRead(scene, GetParam().object).message,
                AllOf(HasSubstr(" is " + std::to_string(GetParam().value) + " ("),
                      testing::EndsWith(GetParam().words)));
    ASSERT_EQ(scene.setpoint("joint", 2.4), "");
    ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") > 0.995 * kSv660cSpeed; }, 3s));
    from_ = scene.position("joint");
  }
  /// The motor was stopped by something just now: it goes as far as the option says.
  void expectStops(Scene& scene, Sv660cWay how = GetParam().way) {
    scene.run(10ms);
    const bool powered = scene.truth("joint").power_stage_on;
    EXPECT_EQ(powered, how != Sv660cWay::coasts && how != Sv660cWay::brake);
    ASSERT_TRUE(scene.runUntil([&] { return std::fabs(scene.velocity("joint")) < 1e-3; }, 3s));
    const double way = sv660cWayOf(how);
    EXPECT_NEAR(scene.position("joint") - from_, way, 0.12 * way + kSv660cSpeed * 0.016);
    scene.run(300ms);
    EXPECT_EQ(scene.truth("joint").power_stage_on, GetParam().holds) << scene.told();
  }
  static std::string withOption() {
    return "{object: " + std::string(GetParam().object) +
           ", raw: " + std::to_string(GetParam().value) + "}";
  }

 private:
  double from_ = 0.0;
};

std::string nameOfSv660cOption(const testing::TestParamInfo<Sv660cOption>& tested) {
  const int value = tested.param.value;
  return std::string(value < 0 ? "Minus" : "Is") + std::to_string(std::abs(value));
}

class Sv660cQuickStop : public Sv660cOptions {};

TEST_P(Sv660cQuickStop, EndsAsItsOptionSays) {
  const std::string hold = GetParam().holds ? ", quick_stop: hold" : "";
  Sv660cReady scene(sv660cWrites(withOption(), sv660cJoint(hold)));
  begin(scene);
  const auto stopped = scene.begin(ProcedureKind::quick_stop, "joint");
  expectStops(scene);
  ASSERT_TRUE(scene.runUntil([&] { return stopped->has_value(); }, 3s));
  EXPECT_TRUE((*stopped)->success) << (*stopped)->message;
  EXPECT_EQ(scene.state("joint").state,
            GetParam().holds ? State::quick_stop_active : State::switch_on_disabled);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "joint");
  ASSERT_TRUE(enabled.success) << enabled.message;
  ASSERT_EQ(scene.setpoint("joint", 0.1), "");
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), 0.1, 1e-5) << "back from there";
}

INSTANTIATE_TEST_SUITE_P(
    Where605Ah, Sv660cQuickStop,
    testing::Values(
        Sv660cOption{"quick_stop_option", 0, Sv660cWay::coasts, false, "coasts, off"},
        Sv660cOption{"quick_stop_option", 1, Sv660cWay::gentle, false,
                     "by 6084h (609Ah in homing), off"},
        Sv660cOption{"quick_stop_option", 2, Sv660cWay::quick, false, "by 6085h, off"},
        Sv660cOption{"quick_stop_option", 3, Sv660cWay::hard, false, "as hard as it can, off"},
        Sv660cOption{"quick_stop_option", 5, Sv660cWay::gentle, true,
                     "by 6084h (609Ah in homing), holds"},
        Sv660cOption{"quick_stop_option", 6, Sv660cWay::quick, true, "by 6085h, holds"},
        Sv660cOption{"quick_stop_option", 7, Sv660cWay::hard, true, "as hard as it can, holds"}),
    nameOfSv660cOption);

class Sv660cDisable : public Sv660cOptions {};

// The driver brings a moving axis to rest by a quick stop first, so that the option never lets it
// coast; what the drive does by itself is tried with the drive alone.
TEST_P(Sv660cDisable, BrakesWhateverItsOptionSays) {
  Sv660cReady scene(sv660cWrites(withOption()));
  begin(scene);
  const auto stopped = scene.begin(ProcedureKind::disable, "joint");
  expectStops(scene, Sv660cWay::quick);
  ASSERT_TRUE(scene.runUntil([&] { return stopped->has_value(); }, 3s));
  EXPECT_TRUE((*stopped)->success) << (*stopped)->message;
}

INSTANTIATE_TEST_SUITE_P(
    Where605Ch, Sv660cDisable,
    testing::Values(Sv660cOption{"disable_operation_option", -4, Sv660cWay::quick, false,
                                 "by 6085h, then dynamic brake"},
                    Sv660cOption{"disable_operation_option", -3, Sv660cWay::hard, false,
                                 "zero speed, then dynamic brake"},
                    Sv660cOption{"disable_operation_option", -2, Sv660cWay::gentle, false,
                                 "by 6084h (609Ah in homing), then dynamic brake"},
                    Sv660cOption{"disable_operation_option", -1, Sv660cWay::brake, false,
                                 "dynamic brake, which stays"},
                    Sv660cOption{"disable_operation_option", 0, Sv660cWay::coasts, false, "coasts"},
                    Sv660cOption{"disable_operation_option", 1, Sv660cWay::gentle, false,
                                 "by 6084h (609Ah in homing), then free"},
                    Sv660cOption{"disable_operation_option", 2, Sv660cWay::brake, false,
                                 "dynamic brake, then free"}),
    nameOfSv660cOption);

class Sv660cHalt : public Sv660cOptions {};

TEST_P(Sv660cHalt, HoldsAsItsOptionSays) {
  Sv660cReady scene(sv660cWrites(withOption(), sv660cJoint({}, {}, "0.004", "[pv, pp, ip]")), "pp");
  begin(scene);
  const auto halted = scene.begin(ProcedureKind::halt, "joint");
  expectStops(scene);
  ASSERT_TRUE(scene.runUntil([&] { return halted->has_value(); }, 3s));
  EXPECT_TRUE((*halted)->success) << (*halted)->message;
}

INSTANTIATE_TEST_SUITE_P(Where605Dh, Sv660cHalt,
                         testing::Values(Sv660cOption{"halt_option", 1, Sv660cWay::gentle, true,
                                                      "by 6084h (609Ah in homing), holds"},
                                         Sv660cOption{"halt_option", 2, Sv660cWay::quick, true,
                                                      "by 6085h, holds"},
                                         Sv660cOption{"halt_option", 3, Sv660cWay::hard, true,
                                                      "as hard as it can, holds"}),
                         nameOfSv660cOption);

class Sv660cFaultStop : public Sv660cOptions {};

TEST_P(Sv660cFaultStop, EndsAsItsOptionSays) {
  Sv660cReady scene(sv660cWrites(withOption()));
  begin(scene);
  scene.inject("joint", "position_command");  // class 2
  expectStops(scene);
  EXPECT_EQ(scene.state("joint").state, State::fault);
}

INSTANTIATE_TEST_SUITE_P(
    Where605Eh, Sv660cFaultStop,
    testing::Values(Sv660cOption{"fault_reaction_option", -5, Sv660cWay::hard, false,
                                 "zero speed, then dynamic brake"},
                    Sv660cOption{"fault_reaction_option", -4, Sv660cWay::hard, false,
                                 "as hard as it can, then dynamic brake"},
                    Sv660cOption{"fault_reaction_option", -3, Sv660cWay::quick, false,
                                 "by 6085h, then dynamic brake"},
                    Sv660cOption{"fault_reaction_option", -2, Sv660cWay::gentle, false,
                                 "by 6084h (609Ah in homing), then dynamic brake"},
                    Sv660cOption{"fault_reaction_option", -1, Sv660cWay::brake, false,
                                 "dynamic brake, which stays"},
                    Sv660cOption{"fault_reaction_option", 0, Sv660cWay::coasts, false, "coasts"},
                    Sv660cOption{"fault_reaction_option", 1, Sv660cWay::gentle, false,
                                 "by 6084h (609Ah in homing), then free"},
                    Sv660cOption{"fault_reaction_option", 2, Sv660cWay::quick, false,
                                 "by 6085h, then free"},
                    Sv660cOption{"fault_reaction_option", 3, Sv660cWay::hard, false,
                                 "as hard as it can, then free"},
                    Sv660cOption{"fault_reaction_option", 4, Sv660cWay::brake, false,
                                 "dynamic brake, then free"}),
    nameOfSv660cOption);

// While stopped only [L15012-15153], and within their ranges.
TEST(Sv660cOptionCodes, AreTakenWhileDisabledAlone) {
  Sv660cReady scene;
  for (const char* object :
       {"quick_stop_option", "disable_operation_option", "halt_option", "fault_reaction_option"}) {
    EXPECT_THAT(sv660cWrite(scene, object, "1").message, HasSubstr("0x08000022")) << object;
  }
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  for (const auto& [object, beyond, range] :
       {std::tuple("quick_stop_option", "8", "0 to 7"),
        std::tuple("disable_operation_option", "-5", "-4 to 2"),
        std::tuple("halt_option", "0", "1 to 3"),
        std::tuple("fault_reaction_option", "5", "-5 to 4")}) {
    EXPECT_TRUE(sv660cWrite(scene, object, "1").success) << object;
    EXPECT_THAT(sv660cWrite(scene, object, beyond).message, HasSubstr(range)) << object;
  }
}

// H0d.05 [L9489]: what kind of stop it is stands nowhere; here it is that of 605Ah.
TEST(Sv660cEmergencyStop, ByItsParameterStopsTheMotorAndIsTold) {
  Sv660cReady scene;
  ASSERT_EQ(scene.setpoint("joint", 2.4), "");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") > 1.4; }, 3s));
  EXPECT_TRUE(sv660cWrite(scene, "H0D.05", "1").success);
  scene.run(1s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-6);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_THAT(scene.told(), HasSubstr("the drive left operation enabled by itself"));
  scene.forget();
  EXPECT_TRUE(sv660cWrite(scene, "emergency_stop", "0").success);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "joint");
  EXPECT_TRUE(enabled.success) << enabled.message;
  scene.run(300ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4) << "what was commanded is given up";
}

}  // namespace
}  // namespace cia402
