// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What drives of the families must be set to before they are enabled or search their home.
#include "system/families_scene.h"
#include "system/refused_enabling.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

/// A row of the drive's dictionary as it comes from the factory, and what is said of it.
struct WrongSetting {
  const char* name;
  FamilyMode tested;
  const char* row;
  const char *told, *remedy;
};

std::string delivered(const std::string& row) {
  return ", simulation: {with: {dictionary: [" + row + "]}}";
}

class FamilySetting : public testing::TestWithParam<WrongSetting> {};

TEST_P(FamilySetting, IsNamedWithItsRemedyAndNothingIsEnabled) {
  expectRefusedEnabling(familyJoint(GetParam().tested, delivered(GetParam().row)), GetParam().told,
                        GetParam().remedy);
}

constexpr FamilyMode kCheckedDm5{"megmeet_dm5", "8388608", "csp"},
    kCheckedNimotion{"nimotion_stepper", "4000", "csp"}, kCheckedId286{"id286_cnfa", "10000", "pp"};

INSTANTIATE_TEST_SUITE_P(
    ThatIsWrong, FamilySetting,
    testing::Values(
        WrongSetting{"Dm5VelocityUnit", kCheckedDm5,
                     "[0x2014, 16, velocity_unit, uint16, rw, -, 1]",
                     "velocity_unit (2014:10) is 1 instead of 0", "set P20.15 to 0"},
        WrongSetting{"Dm5TorqueUnit", kCheckedDm5, "[0x2014, 15, torque_unit, uint16, rw, -, 1]",
                     "torque_unit (2014:0F) is 1 instead of 0", "set P20.14 to 0"},
        WrongSetting{"Dm5Polarity", kCheckedDm5, "[0x607E, 0, polarity, uint8, rw, r, 128]",
                     "polarity (607E:00) is 128 instead of 0", "give the axis a `direction`"},
        WrongSetting{"Dm5Interpolation", kCheckedDm5,
                     "[0x2014, 17, interpolation_off, uint16, rw, -, 1]",
                     "interpolation_off (2014:11) is 1 instead of 0", "set P20.16 to 0"},
        WrongSetting{"Dm5Locked", kCheckedDm5,
                     "[0x2002, 0x16, parameter_protection, uint16, rw, -, 2]",
                     "parameter_protection (2002:16) is 2 instead of 0", "set P02.21 to 0"},
        WrongSetting{"NimotionPolarity", kCheckedNimotion,
                     "[0x607E, 0, polarity, uint8, rw, -, 128]",
                     "polarity (607E:00) is 128 instead of 0", "give the axis a `direction`"},
        WrongSetting{"NimotionSilent", kCheckedNimotion,
                     "[0x200C, 1, CommunicationSelect, uint16, rw, -, 1, 1, 3]",
                     "communication_select (200C:01) is 1 instead of 2", "set 200Ch:01 to 2"},
        WrongSetting{"Id286Counts", kCheckedId286, "[0x20F2, 0, resolution, uint32, rw, -, 4000]",
                     "the drive counts 4000 a turn of its motor (resolution (20F2:00) = 4000)",
                     "counts_per_turn of axes/joint is 10000"}),
    [](const auto& tested) { return std::string(tested.param.name); });

// The factory's P02.00 is 0, position by pulses.
TEST(Dm5ControlMode, IsWrittenOnlyWhereTheAxisAsksForIt) {
  std::string yaml = familyJoint(kCheckedDm5);
  yaml.erase(yaml.find(", adjust: [control_mode]"), 24);
  {
    Scene scene(loadText(yaml));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    EXPECT_FALSE(enabled.success);
    EXPECT_THAT(enabled.message, HasSubstr("control_mode (2002:01) is 0 instead of 7"));
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
    EXPECT_EQ(scene.drive("joint").dictionary().find({0x2002, 1})->number, 0);
  }
  Scene scene(loadText(familyJoint(kCheckedDm5)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x2002, 1})->number, 0) << "not by the boot";
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x2002, 1})->number, 7);
}

// 6072h, 60E0h, 60E1h have no printed default; an axis that gives no effort leaves them as they
// are.
TEST(Dm5Limits, ThatForbidMotionAreNamed) {
  for (const auto& [row, told] :
       {std::pair("[0x6072, 0, max_torque, uint16, rw, r, 0]", "max_torque (6072:00) is 0, not"),
        std::pair("[0x60E0, 0, positive_torque_limit, uint16, rw, r, 0]",
                  "positive_torque_limit (60E0:00) is 0, not above 0"),
        std::pair("[0x60E1, 0, negative_torque_limit, uint16, rw, r, 0]",
                  "negative_torque_limit (60E1:00) is 0, not above 0")}) {
    std::string yaml = familyJoint(kCheckedDm5, delivered(row));
    const std::string effort = ",\n             effort: 60.0";
    yaml.erase(yaml.find(effort), effort.size());
    Scene scene(loadText(yaml));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    EXPECT_FALSE(enabled.success);
    EXPECT_THAT(enabled.message, HasSubstr(told));
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
  }
}

constexpr char kSearch[] =
    ", homing: {method: 17, search_velocity: 0.3, zero_velocity: 0.05, acceleration: 2.0}";

TEST(Dm5Homing, BeginsOnlyWhereATerminalHasTheSwitchOfTheMethod) {
  Scene scene(loadText(
      familyJoint(kCheckedDm5, std::string(kSearch) + ", simulation: {lower_limit_switch: -0.4}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.forget();
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message,
              AllOf(HasSubstr("joint (node 1): does not search its home: di1_function (2003:01)"),
                    HasSubstr("di4_function (2003:04) is 35 instead of 36"),
                    HasSubstr("give a terminal the function 36")));
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_EQ(scene.seen("joint").travel(), 0.0);
}

// Each method with the switches that it is printed to look for or to turn at [L2241-2669].
TEST(Dm5Homing, BeginsByNoMethodWithoutEachOfItsSwitches) {
  struct Needed {
    const char *function, *others;
    std::vector<int> methods;
  };
  const Needed kNeeded[] = {
      {"36",
       "{object: di2_function, raw: 35}, {object: di3_function, raw: 32}",
       {1, 11, 12, 13, 14, 17, 27, 28, 29, 30, 33}},
      {"35",
       "{object: di2_function, raw: 36}, {object: di3_function, raw: 32}",
       {2, 4, 7, 8, 9, 10, 18, 23, 24, 25, 26, 34}},
      {"32",
       "{object: di2_function, raw: 36}, {object: di3_function, raw: 35}",
       {3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30}}};
  for (const Needed& needed : kNeeded) {
    for (const int method : needed.methods) {
      std::string search = kSearch;
      search.replace(search.find("17"), 2, std::to_string(method));
      Scene scene(loadText(familyJoint(
          kCheckedDm5, search +
                           ", write: [{object: di1_function, raw: 0}, {object: di4_function, "
                           "raw: 0}, " +
                           needed.others + "]")));
      ASSERT_TRUE(scene.boot(20s)) << scene.told();
      scene.forget();
      const bus::Answer homed = scene.procedure(ProcedureKind::home);
      EXPECT_FALSE(homed.success) << method;
      EXPECT_THAT(homed.message,
                  HasSubstr("give a terminal the function " + std::string(needed.function)))
          << method;
      EXPECT_EQ(scene.seen("joint").travel(), 0.0) << method;
    }
  }
}

// P12.11 = 2 would move on by 607Ch and read 0 there.
TEST(Dm5Homing, IsRefusedWhereTheOffsetMeansSomethingElse) {
  Scene scene(loadText(familyJoint(
      kCheckedDm5,
      ", homing: {method: 35}" + delivered("[0x200C, 12, home_offset_mode, uint16, rw, -, 2]"))));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, HasSubstr("home_offset_mode (200C:0C) is 2, which nobody has given"));
  EXPECT_FALSE(scene.state("joint").homed);
}

// 2002h:01 = 1 is the maker's own mode; it is taken back while the motor is off.
TEST(NimotionControlMode, IsSetBackBeforeEnabling) {
  Scene scene(loadText(familyJoint(kCheckedNimotion)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto entry = [&] { return scene.drive("joint").dictionary().find({0x2002, 1})->number; };
  scene.drive("joint").dictionary().find({0x2002, 1})->number = 1;
  ASSERT_EQ(entry(), 1);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_EQ(entry(), 0);
}

// Closed loop with one of motor and encoder turned: refused; both turned, or open loop: taken.
TEST(Id286ClosedLoop, IsRefusedWhereMotorAndEncoderCountAgainstEachOther) {
  for (const auto& [mode, direction, taken] :
       {std::tuple("1", "1", false), std::tuple("1", "2", false), std::tuple("1", "3", true),
        std::tuple("0", "1", true)}) {
    Scene scene(loadText(familyJoint(
        kCheckedId286,
        delivered(std::string("[0x20D9, 0, motor_mode, uint16, rw, -, ") + mode +
                  "], [0x20C9, 0, running_direction, uint16, rw, -, " + direction + "]"))));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    EXPECT_EQ(enabled.success, taken) << mode << " " << direction << ": " << enabled.message;
    EXPECT_EQ(scene.truth("joint").power_stage_on, taken);
  }
}

TEST(Id286OpenLoop, IsToldOnce) {
  Scene scene(loadText(familyJoint(kCheckedId286)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  EXPECT_THAT(scene.told(), HasSubstr("motor_mode (20D9:00) is 0 instead of 1, it runs open loop"));
}

// P02.21 [L3180]: a drive that forbids a write names it.
TEST(FamilyLock, IsNamedByEveryWriteThatIsForbidden) {
  Scene scene(loadText(
      familyJoint(kCheckedDm5,
                  ", simulation: {with: {dictionary: [[0x6065, 0, following_error_window, uint32, "
                  "ro, -, 23860929]]}}")));
  ASSERT_TRUE(scene.boot(std::chrono::seconds(20))) << scene.told();
  const bus::Answer refused =
      scene.call(bus::WriteObjectCommand{"joint", "following_error_window", "1000"});
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(
      refused.message,
      testing::AllOf(testing::HasSubstr("0x06010002"),
                     testing::HasSubstr("parameter_protection (2002:16) may be why: "
                                        "parameters are locked (P02.21); set P02.21 to 0")));
}

}  // namespace
}  // namespace cia402
