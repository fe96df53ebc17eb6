// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What an SV660C must be set to at its panel, and what the driver learns of its settings.
#include "system/refused_enabling.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

struct Sv660cWrong {
  const char* name;
  const char* row;
  const char* object;
  const char* remedy;
};

class Sv660cSetting : public testing::TestWithParam<Sv660cWrong> {};

TEST_P(Sv660cSetting, IsNamedWithItsRemedyAndNothingIsEnabled) {
  expectRefusedEnabling(sv660cJoint({}, sv660cDelivered(GetParam().row)), GetParam().object,
                        GetParam().remedy);
}

INSTANTIATE_TEST_SUITE_P(
    ThatIsWrong, Sv660cSetting,
    testing::Values(
        Sv660cWrong{"ControlMode", "[0x2002, 1, control_mode, uint16, rw, -, 1]",
                    "control_mode (2002:01) is 1 instead of 8", "set H02.00 to 8"},
        Sv660cWrong{"Units", "[0x200E, 8, object_unit_system, uint16, rw, -, 1]",
                    "unit_system (200E:08) is 1 instead of 0", "set H0E.07 to 0"},
        Sv660cWrong{"Polarity", "[0x607E, 0, polarity, uint8, rw, -, 128]",
                    "polarity (607E:00) is 128 instead of 0", "give the axis a `direction`"},
        Sv660cWrong{"Direction", "[0x2002, 3, forward_direction, uint16, rw, -, 1]",
                    "forward_direction (2002:03) is 1 instead of 0", "set H02.02 to 0"},
        Sv660cWrong{"CommandRate", "[0x2001, 0x3E, command_rate, uint16, rw, -, 3]",
                    "command_rate (2001:3E) is 3 instead of 2", "leave ip out of `modes`"},
        Sv660cWrong{"Encoder", "[0x2000, 0x20, encoder_resolution, uint32, rw, -, 1048576]",
                    "the drive counts 12500 a turn of its motor",
                    "counts_per_turn of axes/joint is 1"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(Sv660cUnits, AreComparedWithThoseThatTheAxisReckonsIn) {
  expectRefusedEnabling(sv660cJoint(", unit_system: 1"), "unit_system (200E:08) is 0 instead of 1",
                        "give the axis the `unit_system` that it holds");
}

// H0E.07 = 1: 0.01 rpm, and the ms from 0 to 1000 rpm [L9609-9627].
TEST(Sv660cUnits, MayBeSpeedsInRpmAndAccelerationsAsTimes) {
  const std::string units = "[0x200E, 8, object_unit_system, uint16, rw, -, 1]";
  Sv660cReady scene(sv660cJoint(", unit_system: 1", sv660cDelivered(units)), "pv");
  // 4 rad/s^2 of the joint are 200 of the motor, 1909.86 rpm/s: 1000 rpm in 523.6 ms.
  EXPECT_EQ(sv660cNumber(scene, 0x6083), 524U);
  scene.stream("joint", 1.0, 100ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.4, 0.1) << "4 rad/s^2 for 0.1 s, and what is under way";
  scene.stream("joint", 1.0, 300ms);
  // 1 rad/s are 50 of the motor, 477.46 rpm.
  EXPECT_EQ(sv660cNumber(scene, 0x60FF), 47746U);
  EXPECT_NEAR(scene.velocity("joint"), 1.0, 0.005);
  EXPECT_NEAR(scene.state("joint").velocity, 1.0, 0.005) << "606Ch";
}

TEST(Sv660cSettings, AnAxisWithoutIpDoesNotMindTheCommandRate) {
  std::string yaml =
      sv660cJoint(", mode: pp", sv660cDelivered("[0x2001, 0x3E, command_rate, uint16, rw, -, 3]"),
                  "0.004", "[pp, pv]");
  yaml.erase(yaml.find("groups:"));  // which follow trajectories
  Scene scene(loadText(yaml));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
}

/// Enables the axis. @return from operation enabled to the answer, s
double sv660cEnablingTakes(Scene& scene) {
  const auto answer = scene.begin(ProcedureKind::enable, "joint");
  EXPECT_TRUE(scene.runUntil([&] { return scene.truth("joint").power_stage_on; }, 5s));
  const Time enabled = scene.now();
  EXPECT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 5s));
  EXPECT_TRUE(*answer && (*answer)->success) << (*answer ? (*answer)->message : "no answer");
  return toSeconds(scene.now() - enabled);
}

std::string sv660cBrakeTime(const std::string& ms) {
  return sv660cDelivered("[0x2002, 0x0A, brake_delay, uint16, rw, -, " + ms + "]");
}

// H02.09; while it runs the simulated drive loses every edge of the controlword.
TEST(Sv660cBrake, IsWaitedForAsLongAsTheDriveSays) {
  for (const auto& [text, time] :
       {std::pair("0", 0.0), std::pair("250", 0.25), std::pair("500", 0.5)}) {
    for (const char* mode : {"ip", "pp"}) {
      Scene scene(loadText(sv660cJoint(", mode: " + std::string(mode), sv660cBrakeTime(text))));
      ASSERT_TRUE(scene.boot()) << scene.told();
      const double took = sv660cEnablingTakes(scene);
      EXPECT_GE(took, time) << mode;
      EXPECT_LE(took, time + 0.1) << mode;
      ASSERT_EQ(scene.setpoint("joint", 0.3), "") << mode;
      scene.run(3s);
      EXPECT_NEAR(scene.position("joint"), 0.3, 1e-5) << mode << " " << text << scene.told();
    }
  }
}

// Interpolation shall not begin before: controlword bit 4 follows the brake.
TEST(Sv660cBrake, KeepsTheBitsOfTheModeBack) {
  Scene scene(loadText(sv660cJoint(", mode: ip", sv660cBrakeTime("400"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  Time operating = kNever, interpolating = kNever;
  scene.watch([&] {
    const auto word = scene.drive("joint").dictionary().find({0x6040, 0})->number;
    if (scene.truth("joint").power_stage_on) operating = std::min(operating, scene.now());
    if ((word & 0x10) != 0) interpolating = std::min(interpolating, scene.now());
  });
  const auto enabled = scene.procedure(ProcedureKind::enable, "joint");
  ASSERT_TRUE(enabled.success) << enabled.message;
  ASSERT_NE(interpolating, kNever);
  EXPECT_GE(interpolating - operating, 400ms);
}

// The drive tells another position than when it was enabled: here as its gear is another one.
TEST(Sv660cBrake, IsFollowedByATargetWhereTheMotorIsByThen) {
  Scene scene(loadText(sv660cJoint(", mode: ip", "initial_position: 0.02")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto enabled = scene.begin(ProcedureKind::enable, "joint");
  ASSERT_TRUE(scene.runUntil([&] { return scene.truth("joint").power_stage_on; }, 5s));
  scene.forget();
  scene.run(100ms);
  scene.drive("joint").dictionary().find({0x6091, 2})->number = 6250;
  ASSERT_TRUE(scene.runUntil([&] { return enabled->has_value(); }, 5s));
  scene.run(500ms);
  EXPECT_EQ(scene.state("joint").state, drive::State::operation_enabled) << scene.told();
  EXPECT_LT(scene.seen("joint").travel(), 1e-5);
}

TEST(Sv660cBrake, ThatTakesLongerThanTheProfileAllowsForIsRefused) {
  Scene scene(loadText(sv660cJoint({}, sv660cBrakeTime("700"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto enabled = scene.procedure(ProcedureKind::enable, "joint");
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, HasSubstr("brake_delay (2002:0A) is 0.7 s, longer than the 0.5 s"));
}

// 60C2h:01 in ms with the exponent -3, at every period that the drive follows.
TEST(Sv660cPeriod, IsToldInMilliseconds) {
  for (const auto& [text, ms] : {std::pair("0.002", 2U), std::pair("0.004", 4U),
                                 std::pair("0.010", 10U), std::pair("0.020", 20U)}) {
    Scene scene(loadText(sv660cJoint({}, {}, text)));
    ASSERT_TRUE(scene.boot()) << scene.told();
    const auto& dictionary = scene.drive("joint").dictionary();
    EXPECT_EQ(dictionary.find({0x60C2, 1})->number, ms);
    EXPECT_EQ(dictionary.find({0x60C2, 2})->number, 0xFDU);
    const auto enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << text << ": " << enabled.message;
    ASSERT_EQ(scene.setpoint("joint", 0.3), "");
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), 0.3, 1e-5) << text << scene.told();
  }
}

TEST(Sv660cPeriod, ThatItDoesNotFollowIsRefused) {
  const auto problemsOf = [](const char* period) {
    Problems problems;
    config::loadRobot(YAML::Load(sv660cJoint({}, {}, period)),
                      config::profilesIn({test::configFolder() + "/drives"}), problems);
    return problems.text();
  };
  EXPECT_THAT(problemsOf("0.021"), AllOf(HasSubstr("`joint` (profile sv660c) follows no period "
                                                   "above 0.02 s; make it shorter"),
                                         HasSubstr("bus/sync_period")));
  EXPECT_THAT(problemsOf("0.0025"), HasSubstr("takes the period in whole milliseconds"));
  EXPECT_THAT(problemsOf("0.0005"), HasSubstr("follows no period below 0.001 s"));
  EXPECT_EQ(problemsOf("0.02"), "");
}

// H02.02 = 1 [L3400-3418]: the joint stands at 0.02 rad, and the drive counts the other way round.
TEST(Sv660cTurnedRound, ByH0202ReadsTheOtherWayAndIsNotEnabled) {
  Scene scene(loadText(
      sv660cJoint({}, "initial_position: 0.02, " +
                          sv660cDelivered("[0x2002, 3, forward_direction, uint16, rw, -, 1]"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_NEAR(scene.position("joint"), 0.02, 1e-6);
  EXPECT_NEAR(scene.state("joint").position, -0.02, 1e-6) << "the drive obeys";
  const auto enabled = scene.procedure(ProcedureKind::enable, "joint");
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, AllOf(HasSubstr("calls the other direction positive (H02.02)"),
                                     HasSubstr("forward_direction (2002:03) is 1 instead of 0")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

// 607Eh [L15582-15598], written by a service: it is compared again before each enabling.
TEST(Sv660cTurnedRound, ByItsPolarityIsNotEnabledUntilThatIsTakenBack) {
  Sv660cReady scene(sv660cJoint(", homing: {method: 35, required: true}"), "ip");
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  ASSERT_TRUE(scene.state("joint").homed);
  const auto early = sv660cWrite(scene, "polarity", "128");
  EXPECT_FALSE(early.success) << "under power";
  EXPECT_EQ(sv660cNumber(scene, 0x607E), 0U);
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "joint").success);
  const auto written = sv660cWrite(scene, "polarity", "128");
  ASSERT_TRUE(written.success) << written.message;
  scene.run(500ms);
  EXPECT_FALSE(scene.state("joint").homed);
  scene.forget();
  const auto refused = scene.procedure(ProcedureKind::enable, "joint");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("the drive turns signs by itself"),
                                     HasSubstr("polarity (607E:00) is 128 instead of 0")));
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_EQ(scene.seen("joint").travel(), 0.0);
  ASSERT_TRUE(sv660cWrite(scene, "polarity", "0").success);
  scene.run(500ms);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "joint").success) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  ASSERT_EQ(scene.setpoint("joint", 0.3), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 0.3, 1e-5);
}

}  // namespace
}  // namespace cia402
