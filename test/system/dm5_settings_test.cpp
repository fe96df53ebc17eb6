// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Settings of the DM5 that decide whether what the driver writes counts; and its quick-stop
// options.
#include "system/families_motion.h"
#include "system/refused_enabling.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr FamilyMode kDm5Csp{"megmeet_dm5", "8388608", "csp"},
    kDm5Pv{"megmeet_dm5", "8388608", "pv"}, kDm5Pp{"megmeet_dm5", "8388608", "pp"};

/// The drive as it is delivered, but for one row of its dictionary.
std::string dm5With(const std::string& row, const FamilyMode& tested = kDm5Csp,
                    const std::string& more = {}) {
  return familyJoint(tested, more + ", simulation: {with: {dictionary: [" + row + "]}}");
}

struct Dm5Setting {
  const char *name, *row, *told, *remedy;
};
void PrintTo(const Dm5Setting& setting, std::ostream* out) { *out << setting.name; }

class Dm5Channel : public testing::TestWithParam<Dm5Setting> {};

TEST_P(Dm5Channel, ThatDoesNotHearTheBusRefusesEnabling) {
  expectRefusedEnabling(dm5With(GetParam().row), GetParam().told, GetParam().remedy);
}

INSTANTIATE_TEST_SUITE_P(
    All, Dm5Channel,
    testing::Values(
        Dm5Setting{"P07_09", "[0x2007, 10, forward_speed_channel, uint16, rw, -, 0, 0, 2]",
                   "forward_speed_channel (2007:0A) is 0 instead of 1", "set P07.09 to 1"},
        Dm5Setting{"P07_11", "[0x2007, 12, reverse_speed_channel, uint16, rw, -, 0, 0, 2]",
                   "reverse_speed_channel (2007:0C) is 0 instead of 1", "set P07.11 to 1"},
        Dm5Setting{"P06_12", "[0x2006, 13, positive_torque_channel, uint16, rw, -, 3, 0, 3]",
                   "positive_torque_channel (2006:0D) is 3 instead of 1", "set P06.12 to 1"},
        Dm5Setting{"P06_13", "[0x2006, 14, negative_torque_channel, uint16, rw, -, 0, 0, 3]",
                   "negative_torque_channel (2006:0E) is 0 instead of 1", "set P06.13 to 1"},
        Dm5Setting{"P10_01", "[0x200A, 2, communication_timeout_action, uint16, rw, -, 1, 0, 1]",
                   "communication_timeout_action (200A:02) is 1 instead of 0", "set P10.01 to 0"},
        Dm5Setting{"P05_05", "[0x2005, 6, pulses_per_turn, uint32, rw, -, 10000, 0, 8388608]",
                   "the drive counts 10000 a turn of its motor", "counts_per_turn"},
        Dm5Setting{"6091h",
                   "[0x6091, 1, motor_revolutions, uint32, rw, r, 4], "
                   "[0x6091, 2, shaft_revolutions, uint32, rw, r, 1]",
                   "the drive counts 2097152 a turn of its motor", "counts_per_turn"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(Dm5Channels, OfTheSmallerLimitAreTaken) {
  FamilyScene scene(
      dm5With("[0x2007, 10, forward_speed_channel, uint16, rw, -, 2, 0, 2], "
              "[0x2007, 12, reverse_speed_channel, uint16, rw, -, 2, 0, 2], "
              "[0x2006, 13, positive_torque_channel, uint16, rw, -, 2, 0, 3], "
              "[0x2006, 14, negative_torque_channel, uint16, rw, -, 2, 0, 3]"));
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
}

// P03.00 = 1 and P03.03 = 35 from the factory.
TEST(Dm5Inputs, ThatTheFactoryHasGivenAMeaningAreWarnedOf) {
  FamilyScene delivered(familyJoint(kDm5Csp));
  EXPECT_THAT(
      delivered.told(),
      AllOf(HasSubstr("input 1 is \"servo enable\""), HasSubstr("set P03.00 to 0"),
            HasSubstr("input 4 is the forward limit switch"), HasSubstr("set P03.03 to 0")));
  FamilyScene free(familyJoint(
      kDm5Csp, ", write: [{object: di1_function, raw: 0}, {object: di4_function, raw: 0}]"));
  EXPECT_THAT(free.told(),
              AllOf(Not(HasSubstr("servo enable")), Not(HasSubstr("is the forward limit switch"))));
}

// P05.31: 0 off, 1 on, 2 once it is homed [L3240].
TEST(Dm5SoftwareLimits, CountInTheDriveAsP0531Says) {
  for (const unsigned use : {0U, 1U}) {
    FamilyScene scene(familyJoint(
        kDm5Pv, ", write: [{object: software_limit_mode, raw: " + std::to_string(use) + "}]"));
    EXPECT_EQ(
        scene.told().find("the limits of the joint count in the driver alone") != std::string::npos,
        use == 0);
    const double limit = 0.3 / oneCount(kDm5Pv);
    scene.drive("joint").dictionary().find({0x607D, 2})->number = static_cast<std::uint64_t>(limit);
    scene.drive("joint").dictionary().find({0x607D, 1})->number =
        static_cast<std::uint64_t>(-static_cast<std::int64_t>(limit));
    for (int i = 0; i < 75; ++i) {
      (void)scene.setpoint("joint", 0.6);
      scene.run(20ms);
    }
    if (use == 0) {
      EXPECT_GT(scene.position("joint"), 0.6);
    } else {
      EXPECT_NEAR(scene.position("joint"), 0.3, 0.01);
    }
  }
}

constexpr char kSearchForAMissingSwitch[] =
    ", write: [{object: di1_function, raw: 36}], homing: {method: 17, search_velocity: 0.05, "
    "zero_velocity: 0.02, acceleration: 2.0, timeout: 4.0}, simulation: {lower_limit_switch: "
    "-2.4}";

// P12.09 is nine tenths of homing/timeout: the drive ends it first, by Er.037.
TEST(Dm5Homing, ThatTakesTooLongIsEndedByTheDriveBeforeTheDriver) {
  Scene scene(loadText(familyJoint(kDm5Csp, kSearchForAMissingSwitch)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x200C, 10})->number, 3600U) << "ms";
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  EXPECT_FALSE(homed.success);
  scene.run(200ms);
  EXPECT_THAT(scene.axis("joint").faultText(), AllOf(HasSubstr("0xFF25"), HasSubstr("Er.037")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_FALSE(scene.state("joint").homed);
}

TEST(Dm5Homing, LongerThanP1209HoldsIsRefusedInTheFile) {
  Problems problems;
  const config::RobotConfig robot =
      config::loadRobot(YAML::Load(familyJoint(kDm5Csp, ", homing: {method: 35, timeout: 80.0}")),
                        config::profilesIn({test::configFolder() + "/drives"}), problems);
  (void)config::makeMasterConfig(robot, problems);
  EXPECT_THAT(problems.text(), AllOf(HasSubstr("homing_time_limit"), HasSubstr("does not fit")));
}

/// 605Ah with what becomes of a motor at speed.
struct Dm5Option {
  int option;
  double deceleration;  ///< rad/s^2 of the joint; 0: it coasts
  bool holds;
};
void PrintTo(const Dm5Option& option, std::ostream* out) { *out << option.option; }

class Dm5QuickStop : public testing::TestWithParam<Dm5Option> {};

// limits/acceleration is 4, 6084h; 6085h is twice that.
TEST_P(Dm5QuickStop, StopsAndEndsAsItsOptionSays) {
  const Dm5Option& option = GetParam();
  FamilyScene scene(familyJoint(kDm5Pv, ", write: [{object: quick_stop_option, raw: " +
                                            std::to_string(option.option) + "}]"));
  EXPECT_EQ(scene.number(0x605A), static_cast<std::uint64_t>(option.option));
  scene.stream("joint", 0.7, 600ms);
  const double speed = scene.velocity("joint"), from = scene.position("joint");
  ASSERT_NEAR(speed, 0.7, 0.01);
  const bus::Answer stopped = scene.procedure(ProcedureKind::quick_stop);
  EXPECT_TRUE(stopped.success) << stopped.message;
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-2);
  const double way = scene.position("joint") - from;
  if (option.deceleration > 0.0) {
    const double expected = speed * speed / (2.0 * option.deceleration);
    EXPECT_GT(way, 0.97 * expected);
    EXPECT_LT(way, 1.03 * expected + 0.015 * speed);
  } else {
    EXPECT_GT(way, 0.0);
  }
  scene.run(1s);
  EXPECT_EQ(scene.truth("joint").power_stage_on, option.holds) << stopped.message;
  EXPECT_EQ(scene.state("joint").state,
            option.holds ? drive::State::quick_stop_active : drive::State::switch_on_disabled);
  scene.run(1s);
  scene.expectStands(300ms);
  scene.mustSucceed(ProcedureKind::enable);  // transition 16 where it holds
  scene.expectStands(300ms);
  scene.stream("joint", -0.5, 500ms);
  EXPECT_NEAR(scene.velocity("joint"), -0.5, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Option, Dm5QuickStop,
                         testing::Values(Dm5Option{0, 0.0, false}, Dm5Option{1, 4.0, false},
                                         Dm5Option{2, 8.0, false}, Dm5Option{5, 4.0, true},
                                         Dm5Option{6, 8.0, true}),
                         [](const auto& tested) { return std::to_string(tested.param.option); });

// 605Bh and 605Ch, 0: the power goes and it coasts; 1: by 6084h. 605Dh 1, 2: by 6084h, 6085h.
TEST(Dm5Options, OfHaltAndDisablingAreWhatTheAxisWrites) {
  for (const auto& [option, deceleration] : {std::pair(1, 4.0), std::pair(2, 8.0)}) {
    FamilyScene scene(familyJoint(
        kDm5Pp, ", write: [{object: halt_option, raw: " + std::to_string(option) + "}]"));
    ASSERT_EQ(scene.setpoint("joint", 1.6), "");
    scene.run(1s);
    const double speed = scene.velocity("joint"), from = scene.position("joint");
    ASSERT_GT(speed, 0.6);
    const bus::Answer halted = scene.procedure(ProcedureKind::halt);
    EXPECT_TRUE(halted.success) << halted.message;
    const double expected = speed * speed / (2.0 * deceleration);
    EXPECT_NEAR(scene.position("joint") - from, expected, 0.03 * speed + 0.1 * expected) << option;
    EXPECT_TRUE(scene.truth("joint").power_stage_on);
  }
  for (const char* option : {"0", "1"}) {
    FamilyScene scene(
        familyJoint(kDm5Pp, ", write: [{object: shutdown_option, raw: " + std::string(option) +
                                "}, {object: disable_operation_option, raw: " + option + "}]"));
    ASSERT_EQ(scene.setpoint("joint", 1.6), "");
    scene.run(1s);
    const bus::Answer disabled = scene.procedure(ProcedureKind::disable);
    EXPECT_TRUE(disabled.success) << disabled.message;
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << "a quick stop goes before";
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
  }
}

}  // namespace
}  // namespace cia402
