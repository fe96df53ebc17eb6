// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The homing methods of the SV660C: the joint reads its offset at the true home.
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

constexpr double kMotorTurn = 6.283185307179586 / 50.0;  // of the motor, in rad of the joint
constexpr double kAtHome = 0.25;

// Limit switches at -2.0 and 2.0 (15.92 turns), home switch from 0.5 (3.98 turns) to 0.7 (5.57
// turns), index pulses at 0.3 turns after each whole one.
std::string sv660cSwitches(double start) {
  return "initial_position: " + std::to_string(start) +
         ", lower_limit_switch: -2.0, upper_limit_switch: 2.0, home_switch: [0.5, 0.7], "
         "index_offset: 0.3";
}

std::string sv660cHoming(int method, const std::string& more = {}) {
  return ", homing: {method: " + std::to_string(method) + ", offset: " + std::to_string(kAtHome) +
         ", search_velocity: 0.8, zero_velocity: 0.05, acceleration: 4.0" + more + "}";
}

struct Sv660cHome {
  int method;
  double home, start;  // rad
};

class Sv660cHoming : public testing::TestWithParam<Sv660cHome> {};

TEST_P(Sv660cHoming, FindsTheHomeThatTheManualDraws) {
  const Sv660cHome& c = GetParam();
  Scene scene(loadText(sv660cJoint(sv660cHoming(c.method), sv660cSwitches(c.start))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  EXPECT_TRUE(scene.state("joint").homed);
  EXPECT_NEAR(scene.state("joint").position - kAtHome, scene.position("joint") - c.home, 1e-5);
  EXPECT_EQ(scene.truth("joint").statusword & 0x8000, 0x8000);
  ASSERT_EQ(scene.setpoint("joint", kAtHome), "");
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), c.home, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(
    Methods, Sv660cHoming,
    testing::Values(Sv660cHome{1, -15.7 * kMotorTurn, 0.2}, Sv660cHome{2, 15.3 * kMotorTurn, 0.2},
                    Sv660cHome{3, 3.3 * kMotorTurn, 0.2}, Sv660cHome{4, 4.3 * kMotorTurn, 0.2},
                    Sv660cHome{5, 6.3 * kMotorTurn, 1.0}, Sv660cHome{6, 5.3 * kMotorTurn, 1.0},
                    Sv660cHome{7, 3.3 * kMotorTurn, 0.2}, Sv660cHome{7, 3.3 * kMotorTurn, 1.0},
                    Sv660cHome{8, 4.3 * kMotorTurn, 0.2}, Sv660cHome{9, 5.3 * kMotorTurn, 0.2},
                    Sv660cHome{10, 6.3 * kMotorTurn, 0.2}, Sv660cHome{11, 6.3 * kMotorTurn, 1.0},
                    Sv660cHome{11, 6.3 * kMotorTurn, 0.2}, Sv660cHome{12, 5.3 * kMotorTurn, 1.0},
                    Sv660cHome{13, 4.3 * kMotorTurn, 1.0}, Sv660cHome{14, 3.3 * kMotorTurn, 1.0},
                    Sv660cHome{17, -2.0, 0.2}, Sv660cHome{17, -2.0, -2.2}, Sv660cHome{18, 2.0, 0.2},
                    Sv660cHome{18, 2.0, 2.2}, Sv660cHome{19, 0.5, 0.2}, Sv660cHome{20, 0.5, 0.2},
                    Sv660cHome{21, 0.7, 1.0}, Sv660cHome{22, 0.7, 1.0}, Sv660cHome{23, 0.5, 0.2},
                    Sv660cHome{23, 0.5, 0.6}, Sv660cHome{23, 0.5, 1.0}, Sv660cHome{24, 0.5, 0.2},
                    Sv660cHome{25, 0.7, 0.2}, Sv660cHome{26, 0.7, 0.2}, Sv660cHome{27, 0.7, 1.0},
                    Sv660cHome{27, 0.7, 0.2}, Sv660cHome{28, 0.7, 1.0}, Sv660cHome{29, 0.5, 1.0},
                    Sv660cHome{30, 0.5, 1.0}, Sv660cHome{33, 2.3 * kMotorTurn, 2.6 * kMotorTurn},
                    Sv660cHome{34, 3.3 * kMotorTurn, 2.6 * kMotorTurn}, Sv660cHome{35, 0.9, 0.9}),
    [](const auto& tested) {
      const Sv660cHome& c = tested.param;
      return "Method" + std::to_string(c.method) + "Case" + std::to_string(tested.index);
    });

struct Sv660cStopHome {
  int method;
  double start, home;  // rad
};

class Sv660cHardStop : public testing::TestWithParam<Sv660cStopHome> {};

// Stops at -1.0 (7.96 turns back) and 1.2 (9.55 turns on), index pulses at 0.3 turns after each
// whole one; it pushes with half of the rated torque [L1759-1787].
TEST_P(Sv660cHardStop, IsFoundAndThenTheIndexPulse) {
  const Sv660cStopHome& c = GetParam();
  Scene scene(loadText(sv660cWrites(
      "{object: hard_stop_torque, value: 59.75}, {object: hard_stop_speed, raw: 3}",
      sv660cJoint(sv660cHoming(c.method), "initial_position: " + std::to_string(c.start) +
                                              ", lower_stop: -1.0, upper_stop: 1.2, "
                                              "index_offset: 0.3"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_EQ(sv660cNumber(scene, 0x2005, 0x3B), 500U);
  EXPECT_EQ(sv660cNumber(scene, 0x2005, 0x39), 3U);
  scene.forget();
  const auto homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  EXPECT_NEAR(scene.state("joint").position - kAtHome, scene.position("joint") - c.home, 1e-5);
  if (c.method == -1) {
    EXPECT_NEAR(scene.seen("joint").lowest, -1.0, 1e-6);
  } else if (c.method == -2) {
    EXPECT_NEAR(scene.seen("joint").highest, 1.2, 1e-6);
  } else {
    EXPECT_LT(scene.seen("joint").travel(), 0.7 * kMotorTurn) << "the nearest one";
  }
}

INSTANTIATE_TEST_SUITE_P(By, Sv660cHardStop,
                         testing::Values(Sv660cStopHome{-1, 0.2, -7.7 * kMotorTurn},
                                         Sv660cStopHome{-1, -0.9, -7.7 * kMotorTurn},
                                         Sv660cStopHome{-2, 0.2, 9.3 * kMotorTurn},
                                         Sv660cStopHome{-2, 1.1, 9.3 * kMotorTurn},
                                         Sv660cStopHome{-3, 2.6 * kMotorTurn, 2.3 * kMotorTurn},
                                         Sv660cStopHome{-3, 2.9 * kMotorTurn, 3.3 * kMotorTurn}),
                         [](const auto& tested) {
                           return "Minus" + std::to_string(-tested.param.method) + "Case" +
                                  std::to_string(tested.index);
                         });

// No stop is in the way: the drive gives up by itself, H05.35 in units of 100 ms by H05.66 = 2.
TEST(Sv660cHomingTime, IsWatchedByTheDriveALittleLongerThanByTheHost) {
  Scene scene(loadText(sv660cJoint(sv660cHoming(-1, ", timeout: 6.0"), "initial_position: 1.0")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_EQ(sv660cNumber(scene, 0x2005, 0x43), 2U);
  EXPECT_EQ(sv660cNumber(scene, 0x2005, 0x24), 66U) << "6.6 s";
  const auto homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, HasSubstr("homing timed out after 6 s"));
  scene.run(1s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-6);
  EXPECT_FALSE(scene.state("joint").homed);
}

TEST(Sv660cHomingTime, OfTheDriveThatIsOverIsToldAsE601) {
  Scene scene(loadText(sv660cWrites("{object: H05.35, raw: 15}",
                                    sv660cJoint(sv660cHoming(17), sv660cSwitches(1.9)))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const Time begun = scene.now();
  const auto homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_FALSE(homed.success);
  EXPECT_LT(scene.now() - begun, 5s) << "not the host's 30 s";
  EXPECT_THAT(homed.message, HasSubstr("homing stopped: the drive interrupted it"));
  EXPECT_THAT(scene.told(), HasSubstr("E601 homing took too long"));
  scene.run(500ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-6);
  EXPECT_FALSE(scene.state("joint").homed);
}

TEST(Sv660cHomingMethods, ThatDoNothingOrAreNoneAreRefused) {
  for (const int method : {0, 15, 16, 31, 32, 36, 37}) {
    Problems problems;
    config::loadRobot(YAML::Load(sv660cJoint(sv660cHoming(method))),
                      config::profilesIn({test::configFolder() + "/drives"}), problems);
    EXPECT_THAT(problems.text(), HasSubstr("axes/joint/homing/method")) << method;
  }
}

// [L1376]: bit 10 is set by an interruption, too.
TEST(Sv660cHomingResult, IsNotTakenForHomeWhenItIsInterrupted) {
  Scene scene(loadText(sv660cJoint(sv660cHoming(17), sv660cSwitches(1.0))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto homed = scene.begin(ProcedureKind::home, "joint");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") < -0.7; }, 5s));
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt, "joint").success) << scene.told();
  scene.run(2s);
  ASSERT_TRUE(homed->has_value());
  EXPECT_FALSE((*homed)->success);
  EXPECT_FALSE(scene.state("joint").homed);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-6);
}

// The home switch is not there: the limit switch ends a search of method 19 [L1440-1785].
TEST(Sv660cHomingResult, IsAnErrorInWordsAtALimitSwitch) {
  Scene scene(loadText(
      sv660cJoint(sv660cHoming(19),
                  "initial_position: 0.0, lower_limit_switch: -2.0, upper_limit_switch: 0.4")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, HasSubstr("joint (node 1)"));
  EXPECT_THAT(homed.message, HasSubstr("homing"));
  scene.run(1s);
  EXPECT_FALSE(scene.state("joint").homed);
  EXPECT_LT(scene.position("joint"), 0.49) << "0.8 rad/s end by 4 rad/s^2 after 0.08 rad";
}

// 607Ch counts at once in a drive that has homed [L15530], so that its positions jump.
TEST(Sv660cHomeOffset, ThatIsWrittenLaterIsRefusedUnderPowerAndUnhomes) {
  Sv660cReady scene(sv660cJoint(sv660cHoming(35)));
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  ASSERT_TRUE(scene.state("joint").homed);
  const auto counted = [&] { return static_cast<std::int32_t>(sv660cNumber(scene, 0x6064)); };
  const std::int32_t before = counted();
  EXPECT_FALSE(sv660cWrite(scene, "home_offset", "397887").success) << "under power";
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "joint").success);
  const auto written = sv660cWrite(scene, "home_offset", "397887");
  ASSERT_TRUE(written.success) << written.message;
  scene.run(500ms);
  const double jump = (0.5 - kAtHome) * 50.0 * 100000 / 6.283185307179586;  // 397887 are 0.5 rad
  EXPECT_NEAR(counted() - before, jump, 1.0) << "the drive has taken it";
  EXPECT_FALSE(scene.state("joint").homed);
  scene.forget();
  const auto enabled = scene.procedure(ProcedureKind::enable, "joint");
  EXPECT_TRUE(enabled.success) << enabled.message;
  scene.run(500ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-5);
  const auto again = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(again.success) << again.message << scene.told();
  EXPECT_NEAR(scene.state("joint").position, kAtHome, 1e-5) << "that of the configuration again";
  scene.run(500ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-5) << "method 35, under power: nothing moves";
}

// E09.1 [L15534]: 607Ch beyond 607Dh, which has the limits of the joint once it is homed.
TEST(Sv660cHomeOffset, BeyondTheLimitsThatTheDriveHasIsToldInWords) {
  Sv660cReady scene(sv660cJoint(sv660cHoming(35)));
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  ASSERT_EQ(static_cast<std::int32_t>(sv660cNumber(scene, 0x607D, 2)), 1989437) << "2.5 rad";
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "joint").success);
  EXPECT_TRUE(sv660cWrite(scene, "home_offset", "1989438").success);
  scene.run(500ms);
  EXPECT_THAT(scene.axis("joint").faultText(),
              HasSubstr("EE09 home offset beyond the position limits"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::clear_faults, "joint").success) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  EXPECT_NEAR(scene.state("joint").position, kAtHome, 1e-5);
}

// The driver opens 607Dh before it searches: no E09.1, also the next time.
TEST(Sv660cHomeOffset, BeyondTheLimitsOfTheJointIsTakenEachTime) {
  Sv660cReady scene(sv660cJoint(sv660cWith(sv660cHoming(35), "0.250000", "2.6")));
  for (int i = 0; i < 2; ++i) {
    const auto homed = scene.procedure(ProcedureKind::home, "joint");
    EXPECT_TRUE(homed.success) << homed.message << scene.told();
    EXPECT_NEAR(scene.state("joint").position, 2.6, 1e-5);
    EXPECT_EQ(scene.axis("joint").faultText(), "");
  }
}

}  // namespace
}  // namespace cia402
