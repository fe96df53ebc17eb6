// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Ramps of torques of the DM5 and what its bit 10 means then, its two rules of the following error,
// and what it does with positions that are too far apart or that it does not follow.
#include "system/families_motion.h"
#include "system/refused_enabling.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr FamilyMode kModesPt{"megmeet_dm5", "8388608", "pt"},
    kModesCst{"megmeet_dm5", "8388608", "cst"}, kModesPp{"megmeet_dm5", "8388608", "pp"},
    kModesCsp{"megmeet_dm5", "8388608", "csp"};

/// 6077h, 0.1 % of the rated torque
int dm5Torque(Scene& scene) {
  return static_cast<std::int16_t>(scene.drive("joint").dictionary().find({0x6077, 0})->number);
}

/// Streams an effort and looks at the torque of the motor after each millisecond.
std::vector<int> torquesWhile(FamilyScene& scene, double effort, int milliseconds) {
  std::vector<int> torques;
  for (int ms = 0; ms < milliseconds; ++ms) {
    if (ms % 20 == 0) (void)scene.setpoint("joint", effort);
    scene.run(1ms);
    torques.push_back(dm5Torque(scene));
  }
  return torques;
}

/// 0.1 % a millisecond between these two torques, in the direction of the second; 0: in one step
double slopeOfTorques(const std::vector<int>& torques, int from, int to) {
  const bool up = to > from;
  int first = -1, last = -1;
  for (std::size_t i = 0; i < torques.size(); ++i) {
    const bool begun = up ? torques[i] >= from : torques[i] <= from;
    const bool ended = up ? torques[i] >= to : torques[i] <= to;
    if (begun && first < 0) first = static_cast<int>(i);
    if (ended && last < 0) last = static_cast<int>(i);
  }
  EXPECT_GE(last, 0) << "it was never at " << to;
  if (last <= first + 1) return 0.0;
  const double change =
      torques[static_cast<std::size_t>(last)] - torques[static_cast<std::size_t>(first)];
  return change / (last - first);
}

// 6087h is ten times limits/effort a second: 60 N m are 944.88 / 1000 of 50 * 1.27 N m.
TEST(Dm5Torques, OfPtRiseAndFallBy6087h) {
  FamilyScene scene(familyJoint(kModesPt));
  EXPECT_NEAR(static_cast<double>(scene.number(0x6087)), 9448.8, 1.0);
  scene.inject("joint", "blocked_rotor");
  EXPECT_NEAR(slopeOfTorques(torquesWhile(scene, 60.0, 300), 50, 900), 9.449, 0.2);
  EXPECT_EQ(dm5Torque(scene), 945);
  EXPECT_NEAR(slopeOfTorques(torquesWhile(scene, 3.0, 300), 900, 100), -9.449, 0.2);
}

// Bit 10: more than 20 % until less than 10 %, whatever 6071h is [L2130].
TEST(Dm5Torques, AreNotTakenForReachedByBit10) {
  for (const FamilyMode& tested : {kModesPt, kModesCst}) {
    FamilyScene scene(familyJoint(tested));
    scene.inject("joint", "blocked_rotor");
    const auto bit = [&] { return (scene.truth("joint").statusword & 0x0400) != 0; };
    const auto expect = [&](double effort, int torque, bool reached) {
      EXPECT_EQ(torquesWhile(scene, effort, 300).back(), torque) << effort;
      EXPECT_EQ(bit(), reached) << effort << " N m in " << tested.mode;
      EXPECT_NEAR(scene.state("joint").effort, effort, 0.1);
      EXPECT_EQ(scene.state("joint").error_code, 0);
    };
    expect(6.0, 94, false);  // as it is told, and no bit 10
    expect(20.0, 315, true);
    expect(9.0, 142, true);
    expect(4.0, 63, false);
    expect(-20.0, -315, true);
  }
}

// P07.13 to P07.15 by the axis.
TEST(Dm5Torques, AreComparedWithWhatP0713ToP0715Say) {
  FamilyScene scene(familyJoint(
      kModesPt,
      ", write: [{object: torque_reached_reference, raw: 100}, {object: torque_reached_on, raw: "
      "300}, {object: torque_reached_off, raw: 250}]"));
  scene.inject("joint", "blocked_rotor");
  const auto bitAt = [&](double effort) {
    torquesWhile(scene, effort, 300);
    return (scene.truth("joint").statusword & 0x0400) != 0;
  };
  EXPECT_FALSE(bitAt(24.0)) << "378";
  EXPECT_TRUE(bitAt(27.0)) << "425";
  EXPECT_TRUE(bitAt(24.0));
  EXPECT_FALSE(bitAt(21.0)) << "331";
}

std::string cstWith(const std::string& writes) {
  return familyJoint(kModesCst, ", write: [" + writes + "]");
}

// P20.20 in 0.01 % a millisecond, P20.18 likewise where the torque goes to 0 [L2959-2965].
TEST(Dm5TorqueRamps, AreThoseOfP2020AndP2018) {
  struct Ramps {
    const char* writes;
    double up, down, to_zero;  // 0.1 % a millisecond; 0: at once
  };
  for (const Ramps& ramps :
       {Ramps{"{object: P20.20, raw: 20}", 2.0, -2.0, -2.0},
        Ramps{"{object: P20.18, raw: 40}", 0.0, 0.0, -4.0},
        Ramps{"{object: torque_ramp, raw: 20}, {object: torque_ramp_to_zero, raw: 50}", 2.0, -2.0,
              -5.0},
        Ramps{"{object: stiffness, raw: 14}", 0.0, 0.0, 0.0}}) {
    FamilyScene scene(cstWith(ramps.writes));
    scene.inject("joint", "blocked_rotor");
    EXPECT_NEAR(slopeOfTorques(torquesWhile(scene, 20.0, 260), 20, 300), ramps.up, 0.1)
        << ramps.writes;
    EXPECT_EQ(dm5Torque(scene), 315) << ramps.writes;
    EXPECT_NEAR(slopeOfTorques(torquesWhile(scene, 10.0, 160), 300, 170), ramps.down, 0.1);
    torquesWhile(scene, 20.0, 160);
    EXPECT_NEAR(slopeOfTorques(torquesWhile(scene, 0.0, 260), 300, 20), ramps.to_zero, 0.1);
  }
}

// The host plans its ramps: then the drive must have none [L2965].
TEST(Dm5TorqueRamps, ThatNobodyHasAskedForAreRefused) {
  const auto delivered = [](const FamilyMode& tested, const char* row) {
    return familyJoint(tested, ", simulation: {with: {dictionary: [" + std::string(row) + "]}}");
  };
  constexpr char kRamp[] = "[0x2014, 21, torque_ramp, uint16, rw, -, 20, 0, 65535]";
  expectRefusedEnabling(delivered(kModesCst, kRamp), "torque_ramp (2014:15) is 20",
                        "set P20.20 to 0");
  expectRefusedEnabling(delivered(kModesCst, "[0x2014, 19, to_zero, uint16, rw, -, 7, 0, 65535]"),
                        "torque_ramp_to_zero (2014:13) is 7", "set P20.18 to 0");
  FamilyScene other(delivered(kModesPp, kRamp));
  EXPECT_TRUE(other.truth("joint").power_stage_on) << "it is of cst alone";
}

/// What watches the following error, and how far the joint at 0.8 rad/s runs away before Er.032.
struct Dm5Following {
  const char *name, *writes;
  double distance;  ///< rad
};
void PrintTo(const Dm5Following& tested, std::ostream* out) { *out << tested.name; }

class Dm5FollowingError : public testing::TestWithParam<Dm5Following> {};

TEST_P(Dm5FollowingError, IsAFaultByTheNarrowerOfTwoRules) {
  FamilyScene scene(familyJoint(kModesPp, ", write: [" + std::string(GetParam().writes) + "]"));
  ASSERT_EQ(scene.setpoint("joint", 2.2), "");
  scene.run(1s);
  ASSERT_NEAR(scene.velocity("joint"), 0.8, 0.01);
  scene.inject("joint", "blocked_rotor");
  const Time blocked = scene.now();
  ASSERT_TRUE(scene.runUntil([&] { return !scene.truth("joint").power_stage_on; }, 2s));
  // The motor lags 4 ms behind from the start.
  EXPECT_NEAR(toSeconds(scene.now() - blocked) + 0.004, GetParam().distance / 0.8, 0.004);
  scene.run(100ms);
  EXPECT_THAT(scene.axis("joint").faultText(),
              HasSubstr("0xFF20 position error too large (Er.032)"));
}

// 0.1 rad are 6675442 encoder counts; 6066h is a time that 6065h must be passed for.
INSTANTIATE_TEST_SUITE_P(
    By, Dm5FollowingError,
    testing::Values(
        Dm5Following{"6065h", "{object: following_error_window, value: 0.06}", 0.06},
        Dm5Following{"6066h",
                     "{object: following_error_window, value: 0.06}, {object: "
                     "following_error_time, value: 0.1}",
                     0.06 + 0.08},
        Dm5Following{"P05_21",
                     "{object: following_error_window, value: 0.5}, {object: P05.21, raw: "
                     "6675442}",
                     0.1},
        Dm5Following{"P05_21_before_the_time_of_6066h",
                     "{object: following_error_window, value: 0.05}, {object: "
                     "following_error_time, value: 0.2}, {object: P05.21, raw: 6675442}",
                     0.1},
        Dm5Following{"P05_22",
                     "{object: following_error_window, value: 0.2}, {object: P05.21, raw: "
                     "6675442}, {object: position_error_fault_off, raw: 1}",
                     0.2}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(Dm5FollowingErrors, ThatP0522DoesNotWatchAreWarnedOf) {
  FamilyScene off(familyJoint(kModesPp, ", write: [{object: position_error_fault_off, raw: 1}]"));
  EXPECT_THAT(off.told(), AllOf(HasSubstr("position_error_fault_off (2005:17) is 1 instead of 0"),
                                HasSubstr("set P05.22 to 0")));
  FamilyScene on(familyJoint(kModesPp));
  EXPECT_THAT(on.told(), Not(HasSubstr("P05.22")));
}

// P10.04 = 0 from the factory.
TEST(Dm5Overtravel, ThatLetsTheMotorCoastIsToldOnce) {
  constexpr char kCoasts[] = "at a limit switch it is a fault, and the motor coasts (P10.04)";
  FamilyScene delivered(familyJoint(kModesCsp));
  EXPECT_THAT(delivered.told(), AllOf(HasSubstr(kCoasts), HasSubstr("set P10.04 to 1")));
  const std::string once = delivered.told();
  delivered.mustSucceed(ProcedureKind::disable);
  delivered.mustSucceed(ProcedureKind::enable);
  EXPECT_EQ(delivered.told(), once);
  FamilyScene holds(familyJoint(kModesCsp, ", write: [{object: P10.04, raw: 1}]"));
  EXPECT_THAT(holds.told(), Not(HasSubstr(kCoasts)));
}

// Er.053: how far is too far is not printed; here it is what the driver sends at 0.8 rad/s.
TEST(Dm5PositionSteps, ThatAreTooLargeAreAFaultOfTheDriveAndLeadToNoLeap) {
  FamilyScene scene(
      familyJoint(kModesCsp, ", simulation: {with: {state_machine: {position_step: 0.05}}}"));
  for (int i = 0; i < 100 && scene.truth("joint").power_stage_on; ++i) {
    (void)scene.setpoint("joint", 1.6);
    scene.run(20ms);
  }
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  scene.run(2s);
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr("0xFF35 position step too large (Er.053)"), HasSubstr("check")));
  scene.mustSucceed(ProcedureKind::clear_faults);
  scene.mustSucceed(ProcedureKind::enable);
  scene.expectStands(1s);
  ASSERT_TRUE(scene.move({scene.state("joint").position + 0.2}, 2s).success) << "a slower one";
  scene.run(500ms);
  EXPECT_EQ(scene.axis("joint").faultText(), "");
}

// As far as its motor can turn no step is.
TEST(Dm5PositionSteps, OfTheFastestMotionAreTaken) {
  FamilyScene scene(familyJoint(kModesCsp));
  ASSERT_EQ(scene.setpoint("joint", 2.0), "");
  scene.run(5s);
  EXPECT_NEAR(scene.position("joint"), 2.0, 1e-4);
  EXPECT_NEAR(scene.seen("joint").fastest, 0.8, 0.01);
}

/// A joint in csp whose drive drops its targets, with bit 12 = 0, while an object says so [L2768].
struct DroppingDm5 : FamilyScene {
  DroppingDm5()
      : FamilyScene(familyJoint(
            kModesCsp,
            ", simulation: {with: {dictionary: [[0x2FFF, 0, dropped, uint8, rw, -, 0]], objects: "
            "{targets_dropped: \"2FFF:00\"}}}")) {
    run(300ms);
    EXPECT_TRUE(bit12());
  }
  void drop(unsigned dropped) { drive("joint").dictionary().find({0x2FFF, 0})->number = dropped; }
  bool bit12() { return (truth("joint").statusword & 0x1000) != 0; }
  bool givenUp() const {
    return told().find("what was commanded is given up") != std::string::npos;
  }
};

// Without bit 12 the motor would be missed after 0.15 s.
TEST(Dm5Targets, ThatTheDriveDropsFromRestAreSeenByBit12) {
  DroppingDm5 scene;
  scene.drop(1);
  scene.run(300ms);
  ASSERT_FALSE(scene.bit12());
  const Time from = scene.now();
  const auto given_up = [&] {
    (void)scene.setpoint("joint", 0.8);
    return scene.givenUp();
  };
  EXPECT_TRUE(scene.runUntil(given_up, 1s)) << scene.told();
  EXPECT_LT(toSeconds(scene.now() - from), 0.14);
  EXPECT_NEAR(scene.position("joint"), 0.0, 1e-3);
}

TEST(Dm5Targets, ThatTheDriveDoesNotFollowAreToldAndGivenUp) {
  DroppingDm5 scene;
  ASSERT_EQ(scene.setpoint("joint", 1.6), "");
  scene.run(700ms);
  ASSERT_GT(scene.velocity("joint"), 0.3);
  scene.drop(1);
  scene.run(8ms);
  EXPECT_FALSE(scene.bit12());
  scene.run(700ms);
  EXPECT_TRUE(scene.givenUp()) << scene.told();
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  scene.drop(0);
  scene.expectStands(1s, 2e-3);
  scene.mustSucceed(ProcedureKind::enable);
  scene.expectStands(500ms, 2e-3);
  const double from = scene.position("joint");
  ASSERT_EQ(scene.setpoint("joint", scene.state("joint").position + 0.3), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint") - from, 0.3, 1e-3);
}

}  // namespace
}  // namespace cia402
