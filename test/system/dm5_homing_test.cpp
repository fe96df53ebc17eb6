// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The DM5 looks for home at hard stops; what 607Ch is for by P12.11; searches that it refuses; and
// switches whose contacts are closed at rest. Where home is says the motor.
#include "system/families_homing.h"
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr FamilyMode kHomingDm5{"megmeet_dm5", "8388608", "pp"};
constexpr double kDm5Turn = 6.283185307179586 / 50.0;        // of the motor, in rad of the joint
constexpr double kDm5AtHome = 0.25;                          // what the joint is to read there
constexpr double kDm5LowerStop = -1.0, kDm5UpperStop = 1.2;  // 7.958 turns back, 9.549 turns on

std::string dm5Search(int method, const std::string& writes, const std::string& places) {
  return familyJoint(kHomingDm5, ", homing: {method: " + std::to_string(method) +
                                     ", offset: 0.25, search_velocity: 0.8, zero_velocity: 0.16, "
                                     "acceleration: 4.0, timeout: 20.0}, write: [" +
                                     writes + "], simulation: {" + places + "}");
}

std::string dm5Stops(double start) {
  return "initial_position: " + std::to_string(start) +
         ", lower_stop: -1.0, upper_stop: 1.2, index_offset: 0.3";
}

/// 30 N m are 472.4 / 1000 of 50 * 1.27 N m, behind the limit of 60 N m.
std::string dm5Push(const std::string& time) {
  return "{object: hard_stop_torque, value: 30.0}, {object: hard_stop_time, value: " + time + "}";
}

struct Dm5StopHome {
  int method;
  double start, home;  // rad
  double lowest, highest;
};
void PrintTo(const Dm5StopHome& home, std::ostream* out) {
  *out << "method " << home.method << " from " << home.start;
}

class Dm5HardStop : public testing::TestWithParam<Dm5StopHome> {};

TEST_P(Dm5HardStop, IsHomeOrTheIndexPulseBesideItIs) {
  const Dm5StopHome& c = GetParam();
  Scene scene(loadText(dm5Search(c.method, dm5Push("0.05"), dm5Stops(c.start))));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x2017, 21})->number, 472U) << "0.1 %";
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x2017, 22})->number, 50U) << "ms";
  scene.forget();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  EXPECT_TRUE(scene.state("joint").homed);
  EXPECT_NEAR(scene.state("joint").position - kDm5AtHome, scene.position("joint") - c.home, 1e-5);
  if (c.lowest < 0.0) {
    EXPECT_NEAR(scene.seen("joint").lowest, c.lowest, 1e-5) << "it was at that stop";
  } else {
    EXPECT_GT(scene.seen("joint").lowest, c.start - 1e-3) << "it does not go there";
  }
  if (c.highest > 0.0) {
    EXPECT_NEAR(scene.seen("joint").highest, c.highest, 1e-5) << "it was at that stop";
  } else {
    EXPECT_LT(scene.seen("joint").highest, c.start + 1e-3) << "it does not go there";
  }
}

// Stops [L2677-2718]: -1 forwards, -2 back; -3 back and then the next index pulse forwards, -4
// forwards and then the next one back. Index pulses are 0.3 turns after each whole one.
INSTANTIATE_TEST_SUITE_P(By, Dm5HardStop,
                         testing::Values(Dm5StopHome{-1, 0.2, kDm5UpperStop, 0.0, kDm5UpperStop},
                                         Dm5StopHome{-1, -0.9, kDm5UpperStop, 0.0, kDm5UpperStop},
                                         Dm5StopHome{-2, 0.2, kDm5LowerStop, kDm5LowerStop, 0.0},
                                         Dm5StopHome{-2, 1.1, kDm5LowerStop, kDm5LowerStop, 0.0},
                                         Dm5StopHome{-3, 0.2, -7.7 * kDm5Turn, kDm5LowerStop, 0.0},
                                         Dm5StopHome{-4, 0.2, 9.3 * kDm5Turn, 0.0, kDm5UpperStop}),
                         [](const auto& tested) {
                           return "Minus" + std::to_string(-tested.param.method) + "Case" +
                                  std::to_string(tested.index);
                         });

// From where the motor has come to the stop until the drive says that home was found.
TEST(Dm5HardStopTime, IsHowLongTheMotorPushes) {
  double times[2] = {0.0, 0.0};
  for (const int i : {0, 1}) {
    Scene scene(loadText(dm5Search(-2, dm5Push(i == 0 ? "0.05" : "0.65"), dm5Stops(-0.8))));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    Time met = kNever, found = kNever;
    unsigned strongest = 0;
    scene.watch([&] {
      const bool there = scene.position("joint") < kDm5LowerStop + 1e-6;
      if (there && met == kNever) met = scene.now();
      const auto torque =
          static_cast<std::int16_t>(scene.drive("joint").dictionary().find({0x6077, 0})->number);
      strongest = std::max(strongest, static_cast<unsigned>(std::abs(torque)));
      const bool attained = (scene.truth("joint").statusword & 0x1000) != 0;
      if (attained && met != kNever && found == kNever) found = scene.now();
    });
    ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
    ASSERT_NE(found, kNever);
    times[i] = toSeconds(found - met);
    EXPECT_GE(strongest, 472U) << "P23.20";
    EXPECT_GE(times[i], i == 0 ? 0.05 : 0.65);
  }
  EXPECT_NEAR(times[1] - times[0], 0.6, 0.01);
}

// 30 % for 1 ms from the factory: nobody has said that the axis may push so.
TEST(Dm5HardStops, AreSearchedOnlyWhereTheAxisHasGivenTorqueAndTime) {
  for (const int method : {-4, -3, -2, -1}) {
    for (const auto& [writes, told] :
         {std::pair("", "hard_stop_torque (2017:15) is 300, which nobody has given"),
          std::pair("{object: hard_stop_torque, value: 30.0}",
                    "hard_stop_time (2017:16) is 1, which nobody has given"),
          std::pair("{object: hard_stop_time, value: 0.05}",
                    "hard_stop_torque (2017:15) is 300, which nobody has given")}) {
      Scene scene(loadText(dm5Search(method, writes, dm5Stops(0.2))));
      ASSERT_TRUE(scene.boot(20s)) << scene.told();
      scene.forget();
      const bus::Answer refused = scene.procedure(ProcedureKind::home, "joint");
      EXPECT_FALSE(refused.success) << method << writes;
      EXPECT_THAT(refused.message,
                  AllOf(HasSubstr(told), HasSubstr("give hard_stop_torque and hard_stop_time")));
      scene.run(300ms);
      EXPECT_FALSE(scene.truth("joint").power_stage_on);
      EXPECT_EQ(scene.seen("joint").travel(), 0.0);
    }
  }
}

/// What the joint does and reads by P12.11, with home at -0.4 rad and 607Ch of 0.25 rad.
struct Dm5OffsetMode {
  int number;
  double rests;  ///< rad, where it comes to rest, within a ramp
  double reads;  ///< more than the motor's own place, rad
};
void PrintTo(const Dm5OffsetMode& mode, std::ostream* out) { *out << mode.number; }

class Dm5HomeOffset : public testing::TestWithParam<Dm5OffsetMode> {};

TEST_P(Dm5HomeOffset, IsWhatP1211SaysWhereTheAxisAsksForThat) {
  const Dm5OffsetMode& c = GetParam();
  Scene scene(
      loadText(dm5Search(17,
                         "{object: di1_function, raw: 36}, {object: home_offset_mode, raw: " +
                             std::to_string(c.number) + "}",
                         "initial_position: 0.1, lower_limit_switch: -0.4")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x200C, 12})->number,
            static_cast<std::uint64_t>(c.number));
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  EXPECT_EQ(sim::asSigned(*scene.drive("joint").dictionary().find({0x607C, 0})), 16688605)
      << "0.25 rad are 1.989437 turns";
  EXPECT_TRUE(scene.state("joint").homed);
  EXPECT_NEAR(scene.position("joint"), c.rests, c.number < 2 ? 0.01 : 1e-6);
  EXPECT_NEAR(scene.state("joint").position - scene.position("joint"), c.reads, 2e-6);
  scene.forget();
  scene.run(500ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-6);
  ASSERT_EQ(scene.setpoint("joint", scene.state("joint").position + 0.2), "");
  scene.run(2s);
  EXPECT_NEAR(scene.position("joint"), c.rests + 0.2, c.number < 2 ? 0.01 : 1e-5);
}

// [L2212-2220]: 0, home reads 607Ch; 1, what was read there and 607Ch; 2 and 3, it moves on by
// 607Ch, where it reads 0 or 607Ch.
INSTANTIATE_TEST_SUITE_P(By, Dm5HomeOffset,
                         testing::Values(Dm5OffsetMode{0, -0.4, 0.65}, Dm5OffsetMode{1, -0.4, 0.25},
                                         Dm5OffsetMode{2, -0.15, 0.15},
                                         Dm5OffsetMode{3, -0.15, 0.4}),
                         [](const auto& tested) { return std::to_string(tested.param.number); });

// Something has changed what the driver wrote: Er.066 [L3780].
TEST(Dm5HomingLogic, ThatIsWrongIsAFaultOfTheDriveToldInWords) {
  for (const fieldbus::ObjectId id :
       {fieldbus::ObjectId{0x6098, 0}, fieldbus::ObjectId{0x6099, 1}, fieldbus::ObjectId{0x6099, 2},
        fieldbus::ObjectId{0x609A, 0}}) {
    Scene scene(loadText(dm5Search(17, "{object: di1_function, raw: 36}",
                                   "initial_position: 0.1, lower_limit_switch: -0.4")));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    scene.watch([&] { scene.drive("joint").dictionary().find(id)->number = 0; });
    scene.forget();
    const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
    EXPECT_FALSE(homed.success) << fieldbus::toString(id);
    EXPECT_THAT(homed.message, HasSubstr("joint (node 1): fault"));
    scene.run(100ms);
    EXPECT_THAT(scene.axis("joint").faultText(),
                AllOf(HasSubstr("0xFF42 homing logic (Er.066)"), HasSubstr("check method")));
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
    EXPECT_FALSE(scene.state("joint").homed);
    EXPECT_LT(scene.seen("joint").travel(), 1e-6);
  }
}

/// A motor that has just set off to a position, which nobody has measured yet: the simulated drive
/// faults, and coasts, where a search begins before it stands.
TEST(Dm5Homing, OutOfAMotionBeginsOnceTheMotorStands) {
  Scene scene(loadText(dm5Search(35, "{object: di1_function, raw: 0}", "initial_position: 0.1")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const std::string set = scene.procedure(ProcedureKind::home, "joint").message;
  ASSERT_TRUE(scene.state("joint").homed) << set;
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  ASSERT_EQ(scene.setpoint("joint", 1.5), "");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") > 0.01; }, 50ms));
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_TRUE(homed.success) << homed.message;
  EXPECT_TRUE(scene.truth("joint").power_stage_on) << scene.told();
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-6);
  EXPECT_NEAR(scene.state("joint").position, kDm5AtHome, 1e-5) << "that is home";
}

constexpr char kThreeSwitches[] =
    "{object: di1_function, raw: 36}, {object: di2_function, raw: 35}, {object: di3_function, raw: "
    "32}, {object: di4_function, raw: 0}";

/// Limit switches at -2 and 5 and the home switch from 1 to 2.6, index pulses 0.8 turns after each
/// whole one: from the edges of the home switch there is time to become slow before the next.
class Dm5Printing : public testing::TestWithParam<PrintedHoming> {};

TEST_P(Dm5Printing, SaysWhichWaysAndHowFastTheMotorTurns) {
  const std::string switches = ", write: [" + std::string(kThreeSwitches) + "]";
  for (const auto& [start, printed] : GetParam().ways) {
    SCOPED_TRACE(start);
    expectHomingWays(
        replaced(homingJoint({kHomingDm5, switches.c_str(), {GetParam().method, start, 0.0}}),
                 "index_offset: 0.3", "index_offset: 0.8"),
        printed);
  }
}

// [L2241-2669]; before, on and behind the switch, and by 33 and 34 with an index pulse ahead, at
// one and with none before the limit switch.
constexpr double kRear = 0.0, kOnSwitch = 1.7, kFront = 3.6, kIndex = 1.8;
const PrintedHoming kDm5Printed[] = {
    {1, {{kRear, "-F +S"}, {-2.4, "+S"}}},
    {2, {{kFront, "+F -S"}, {5.4, "-S"}}},
    {3, {{kRear, "+F -S"}, {kOnSwitch, "-S"}}},
    {4, {{kRear, "+F +S"}, {kOnSwitch, "-F +F +S"}, {kFront, "+F -F +F +S"}}},
    {5, {{kFront, "-F +S"}, {kOnSwitch, "+S"}}},
    {6, {{kFront, "-F -S"}, {kOnSwitch, "+F -F -S"}}},
    {7, {{kRear, "+F -S"}, {kOnSwitch, "-S"}, {kFront, "+F -F -S"}}},
    {8, {{kRear, "+F +S"}, {kOnSwitch, "-F +F +S"}, {kFront, "+F -F +F +S"}}},
    {9, {{kRear, "+F -F -S"}, {kOnSwitch, "+F -F -S"}, {kFront, "+F -F -S"}}},
    {10, {{kRear, "+F +S"}, {kOnSwitch, "+S"}, {kFront, "+F -F +S"}}},
    {11, {{kRear, "-F +F +S"}, {kOnSwitch, "+S"}, {kFront, "-F +S"}}},
    {12, {{kRear, "-F +F -F -S"}, {kOnSwitch, "+F -F -S"}, {kFront, "-F -S"}}},
    {13, {{kRear, "-F +F +S"}, {kOnSwitch, "-F +F +S"}, {kFront, "-F +F +S"}}},
    {14, {{kRear, "-F +F -S"}, {kOnSwitch, "-S"}, {kFront, "-F -S"}}},
    {17, {{kRear, "-F +S"}, {-2.4, "+S"}}},
    {18, {{kFront, "+F -S"}, {5.4, "-S"}}},
    {19, {{kRear, "+F -S"}, {kOnSwitch, "-S"}}},
    {20, {{kRear, "+F -F +S"}, {kOnSwitch, "-F +S"}}},
    {21, {{kFront, "-F +S"}, {kOnSwitch, "+S"}}},
    {22, {{kFront, "-F +F -S"}, {kOnSwitch, "+F -S"}}},
    {23, {{kRear, "+F -S"}, {kOnSwitch, "-S"}, {kFront, "+F -F -S"}}},
    {24, {{kRear, "+F -F +S"}, {kOnSwitch, "-F +S"}, {kFront, "+F -F +S"}}},
    {25, {{kRear, "+F +S -S"}, {kOnSwitch, "+S -S"}, {kFront, "+F -F +S -S"}}},
    {26, {{kRear, "+F +S"}, {kOnSwitch, "+S"}, {kFront, "+F -F +S"}}},
    {27, {{kRear, "-F +F +S"}, {kOnSwitch, "+S"}, {kFront, "-F +S"}}},
    {28, {{kRear, "-F +F -S"}, {kOnSwitch, "+F -S"}, {kFront, "-F +F -S"}}},
    {29, {{kRear, "-F +F -S +S"}, {kOnSwitch, "-S +S"}, {kFront, "-F -S +S"}}},
    {30, {{kRear, "-F +F -S"}, {kOnSwitch, "-S"}, {kFront, "-F -S"}}},
    {33, {{kOnSwitch, "-S"}, {kIndex, ""}, {-1.6, "-S +S -S"}}},
    {34, {{kOnSwitch, "+S"}, {kIndex, ""}, {4.9, "+S -S +S"}}},
};
INSTANTIATE_TEST_SUITE_P(By, Dm5Printing, testing::ValuesIn(kDm5Printed), printedHomingName);

constexpr char kClosedAtRest[] =  // contacts of DI1 to DI3
    ", with: {terminals: {normally_closed: [0, 1, 2]}}";

/// A method with the switch that it ends at; switches at -0.4, 0.9 and from 0.3 to 0.5 rad.
class Dm5Inversion : public testing::TestWithParam<std::pair<int, double>> {
 protected:
  static std::string joint(int method, const char* inversion) {
    return dm5Search(
        method, std::string(kThreeSwitches) + ", {object: di_inversion, raw: " + inversion + "}",
        "initial_position: 0.1, lower_limit_switch: -0.4, upper_limit_switch: 0.9, "
        "home_switch: [0.3, 0.5]" +
            std::string(kClosedAtRest));
  }
};

// P03.13 = 7: an open contact is an active input [L3197].
TEST_P(Dm5Inversion, LetsContactsThatAreClosedAtRestFindHome) {
  Scene scene(loadText(joint(GetParam().first, "7")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x2003, 14})->number, 7U);
  const auto inputs = [&] { return scene.drive("joint").dictionary().find({0x60FD, 0})->number; };
  EXPECT_EQ(inputs(), 0U) << "no switch is pressed";
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  EXPECT_NEAR(scene.state("joint").position - kDm5AtHome,
              scene.position("joint") - GetParam().second, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(By, Dm5Inversion,
                         testing::Values(std::pair(17, -0.4), std::pair(18, 0.9),
                                         std::pair(19, 0.3), std::pair(26, 0.5)),
                         [](const auto& tested) {
                           return "Method" + std::to_string(tested.param.first);
                         });

// Without it these contacts are taken for pressed switches, by functions and by terminals.
TEST(Dm5Inversions, ThatAreMissingShowInTheInputsAndLetTheAxisNotMove) {
  Scene scene(
      loadText(familyJoint({"megmeet_dm5", "8388608", "pv"},
                           ", write: [" + std::string(kThreeSwitches) +
                               "], simulation: {lower_limit_switch: -0.4, upper_limit_switch: 0.9, "
                               "home_switch: [0.3, 0.5]" +
                               kClosedAtRest + "}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto told = scene.call(bus::ReadObjectCommand{"joint", "digital_inputs"});
  EXPECT_THAT(told.message, AllOf(HasSubstr("reverse limit"), HasSubstr("forward limit"),
                                  HasSubstr("home switch"), HasSubstr("di1, di2, di3")));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.forget();
  for (int i = 0; i < 20; ++i) {
    (void)scene.setpoint("joint", 0.4);
    scene.run(20ms);
  }
  EXPECT_LT(scene.seen("joint").travel(), 1e-3);
  EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("0xFF27 forward limit switch (Er.039)"));
}

}  // namespace
}  // namespace cia402
