// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Terminals and virtual inputs of a NiMotion: what they are for, and what is looked at before.
#include <tuple>

#include "system/families_motion.h"
#include "system/refused_enabling.h"
#include "system/traced_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr FamilyMode kNimotionPp{kNimotionStepper, "4000", "pp"};

std::string withWrites(const std::string& writes) { return ", write: [" + writes + "]"; }
std::string rawWrite(const std::string& object, int number) {
  return "{object: " + object + ", raw: " + std::to_string(number) + "}";
}
std::string terminalWrites(const std::string& name, int function, int logic) {
  return rawWrite(name + "_function", function) + ", " + rawWrite(name + "_logic", logic);
}
std::string searchingBy(int method, const std::string& more) {
  return ", homing: {method: " + std::to_string(method) +
         ", search_velocity: 0.4, zero_velocity: 0.05, acceleration: 2.0}" + more;
}

/// Functions and logic of inputs that do not go together, and what is said.
struct WrongTerminal {
  const char* name;
  std::string writes;
  const char *told, *remedy;
};
void PrintTo(const WrongTerminal& wrong, std::ostream* out) { *out << wrong.name; }

class NimotionTerminal : public testing::TestWithParam<WrongTerminal> {};

TEST_P(NimotionTerminal, IsNamedWithItsRemedyAndNothingIsEnabled) {
  expectRefusedEnabling(familyJoint(kNimotionPp, withWrites(GetParam().writes)), GetParam().told,
                        GetParam().remedy);
}

// [1799-1822, 1834-1839, 1851-1866]
INSTANTIATE_TEST_SUITE_P(
    ThatIsWrong, NimotionTerminal,
    testing::Values(
        WrongTerminal{"FunctionOnTwoTerminals",
                      terminalWrites("di0", 15, 0) + ", " + terminalWrites("di3", 15, 1),
                      "di0_function (2003:01) and di3_function (2003:07) are both 15",
                      "give one of them another function, or 0"},
        WrongTerminal{"FunctionOfAVirtualInput", terminalWrites("di1", 2, 2),
                      "di1_function (2003:03) and vdi2_function (2017:05) are both 2",
                      "give one of them another function, or 0"},
        WrongTerminal{"SwitchByEdges", terminalWrites("di2", 31, 2), "di2_logic (2003:06) is 2",
                      "write 0 (active low) or 1 (active high) to it"},
        WrongTerminal{
            "EdgeByLevel", rawWrite("vdi3_function", 0) + ", " + terminalWrites("di4", 38, 1),
            "di4_logic (2003:0A) is 1", "write 2 (rising), 3 (falling) or 4 (both) to it"},
        WrongTerminal{"UnknownFunction", terminalWrites("di0", 7, 0), "di0_function (2003:01) is 7",
                      "write 0 to it"},
        WrongTerminal{"PulsesAtAnotherTerminal", terminalWrites("di1", 44, 0),
                      "di1_function (2003:03) is 44", "write 0 to it"},
        WrongTerminal{"VirtualSwitch", terminalWrites("vdi4", 15, 0),
                      "vdi4_function (2017:09) is 15", "write 0 to it"},
        WrongTerminal{"VirtualEdgeByLevel", rawWrite("vdi2_logic", 0), "vdi2_logic (2017:06) is 0",
                      "write 1 (rising edge) to it"},
        WrongTerminal{"VirtualLevelByEdge", terminalWrites("vdi5", 1, 1),
                      "vdi5_logic (2017:0C) is 1", "write 0 (active high) to it"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(NimotionTerminals, ThatGoTogetherAreTaken) {
  FamilyScene scene(familyJoint(
      kNimotionPp,
      withWrites(rawWrite("vdi1_function", 0) + ", " + rawWrite("vdi2_function", 0) + ", " +
                 rawWrite("vdi3_function", 0) + ", " + terminalWrites("di0", 15, 0) + ", " +
                 terminalWrites("di1", 2, 3) + ", " + terminalWrites("di2", 33, 4) + ", " +
                 terminalWrites("di3", 38, 2) + ", " + terminalWrites("di4", 14, 0) + ", " +
                 rawWrite("dx0_is_output", 0) + ", " + rawWrite("dx1_is_output", 0) + ", " +
                 rawWrite("di_pull_up", 5) + ", " + terminalWrites("vdi6", 12, 0)) +
          ", simulation: {lower_limit_switch: -2.4, upper_limit_switch: 2.4}"));
  EXPECT_EQ(scene.number(0x2003, 11), 5U);
  EXPECT_EQ(scene.number(0x2021, 1), 0U);
  EXPECT_EQ(scene.number(0x2021, 2), 0U);
  ASSERT_EQ(scene.setpoint("joint", 0.4), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 0.4, 1e-3) << scene.told();
}

TEST(NimotionTerminals, AreSetWhileItIsDisabledOnly) {
  FamilyScene scene(familyJoint(kNimotionPp));
  for (const char* name : {"di0_function", "di0_logic", "di_pull_up", "dx0_is_output",
                           "vdi4_function", "vdi4_logic", "do0_function", "do1_logic"}) {
    const auto refused = scene.call(bus::WriteObjectCommand{"joint", name, "0"});
    EXPECT_FALSE(refused.success) << name;
    EXPECT_THAT(refused.message, HasSubstr("disable it first")) << name;
  }
  scene.mustSucceed(ProcedureKind::disable);
  scene.run(200ms);
  const auto taken = scene.call(bus::WriteObjectCommand{"joint", "di0_function", "31"});
  EXPECT_TRUE(taken.success) << taken.message;
  EXPECT_EQ(scene.number(0x2003, 1), 31U);
}

// The levels of 200Bh:03 are the electrical ones [1822-1828].
TEST(NimotionTerminals, TellTheLevelsOfTheirSwitches) {
  Scene scene(loadText(familyJoint(
      kNimotionPp, withWrites(terminalWrites("di1", 15, 0) + ", " + terminalWrites("di3", 31, 1) +
                              ", " + rawWrite("dx0_is_output", 0)) +
                       ", simulation: {initial_position: 0.0, lower_limit_switch: -0.5, "
                       "home_switch: [-0.1, 0.1]}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.run(300ms);
  const auto read = scene.call(bus::ReadObjectCommand{"joint", "digital_inputs"});
  EXPECT_THAT(read.message, HasSubstr(" 10 (0x000A): di1, di3"))
      << "the limit switch is not active, low; the home switch is, high";
}

TEST(NimotionHoming, BeginsOnlyWhereTheSwitchesOfTheMethodAreAtTerminals) {
  const std::string home = terminalWrites("di0", 31, 1), lower = terminalWrites("di1", 15, 1),
                    upper = terminalWrites("di2", 14, 1);
  struct Row {
    int method;
    std::string given;
    const char* missing;
  };
  for (const Row& row : {Row{17, home + ", " + upper, "negative limit switch"},
                         Row{18, home + ", " + lower, "positive limit switch"},
                         Row{19, lower + ", " + upper, "home switch"},
                         Row{24, home + ", " + lower, "positive limit switch"},
                         Row{24, upper + ", " + lower, "home switch"},
                         Row{30, home + ", " + upper, "negative limit switch"}}) {
    Scene scene(loadText(familyJoint(kNimotionPp, searchingBy(row.method, withWrites(row.given)))));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    scene.forget();
    const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
    EXPECT_FALSE(homed.success) << row.method;
    EXPECT_THAT(homed.message, AllOf(HasSubstr("does not search its home: "),
                                     HasSubstr(row.missing), HasSubstr("by `write` of the axis")));
    scene.run(300ms);
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
    EXPECT_EQ(scene.seen("joint").travel(), 0.0);
  }
}

// DI3 and DI4 are outputs from the factory, 2021h = 1 [2653-2656]: a switch there does not exist.
TEST(NimotionHoming, BeginsOnlyWhereTheTerminalOfASwitchIsAnInput) {
  for (const auto& [terminal, direction, told] :
       {std::tuple("di3", "dx0_is_output", "dx0_is_output (2021:01) is 1 instead of 0"),
        std::tuple("di4", "dx1_is_output", "dx1_is_output (2021:02) is 1 instead of 0")}) {
    for (const bool is_input : {false, true}) {
      const std::string writes = terminalWrites(terminal, 15, 1) +
                                 (is_input ? ", " + rawWrite(direction, 0) : std::string());
      Scene scene(loadText(familyJoint(
          kNimotionPp,
          searchingBy(17, withWrites(writes) + ", simulation: {lower_limit_switch: -0.3}"))));
      ASSERT_TRUE(scene.boot(20s)) << scene.told();
      const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
      EXPECT_EQ(homed.success, is_input) << homed.message;
      if (!is_input) {
        EXPECT_THAT(homed.message, AllOf(HasSubstr("does not search its home: "), HasSubstr(told)));
        EXPECT_EQ(scene.position("joint"), 0.0);
      }
    }
  }
}

// A terminal that gets a function of another one after the look: the drive itself says so.
TEST(NimotionHoming, IsStoppedByAlarm6320WithAHint) {
  Scene scene(loadText(
      familyJoint(kNimotionPp, searchingBy(17, std::string(kNimotionSwitches) +
                                                   ", simulation: {lower_limit_switch: -2.0}"))));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto homed = scene.begin(ProcedureKind::home, "joint");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") < -0.3; }, 8s)) << scene.told();
  scene.inject("joint", "terminal_setup");
  ASSERT_TRUE(scene.runUntil([&] { return homed->has_value(); }, 10s));
  EXPECT_FALSE((*homed)->success);
  EXPECT_THAT((*homed)->message + scene.told(),
              AllOf(HasSubstr("0x6320"), HasSubstr("given to two inputs"),
                    HasSubstr("correct 2003h and 2017h while disabled")));
  scene.run(1s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_FALSE(scene.state("joint").homed);
}

TEST(NimotionTerminals, WithOneFunctionTwiceAreTheAlarm6320UntilThatIsMended) {
  Scene scene(loadText(familyJoint(kNimotionPp)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto write = [&](const char* name, const char* value) {
    const auto written = scene.call(bus::WriteObjectCommand{"joint", name, value});
    EXPECT_TRUE(written.success) << written.message;
    scene.run(200ms);
  };
  scene.run(1s);
  write("di0_function", "33");  // VDI1 has it from the factory
  EXPECT_TRUE(scene.state("joint").warning);
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr("0x6320"), HasSubstr("given to two")));
  write("vdi1_function", "0");
  EXPECT_FALSE(scene.state("joint").warning);
  EXPECT_EQ(scene.axis("joint").faultText(), "");
}

// Function 38 of VDI3, function 2 of VDI2 [1808, 1870-1874]
TEST(NimotionVirtualInputs, ResetFaultsAndClearTheHistory) {
  Scene scene(loadText(familyJoint(kNimotionPp)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.inject("joint", "over_current");
  scene.run(200ms);
  EXPECT_NE(scene.axis("joint").faultText(), "");
  const auto level = [&](const char* value) {
    const auto written = scene.call(bus::WriteObjectCommand{"joint", "virtual_inputs", value});
    EXPECT_TRUE(written.success) << written.message;
    scene.run(400ms);
  };
  level("2");
  EXPECT_EQ(scene.axis("joint").faultText(), "");
  EXPECT_FALSE(scene.call(bus::ErrorHistoryCommand{"joint"}).history.entries.empty());
  level("6");
  EXPECT_TRUE(scene.call(bus::ErrorHistoryCommand{"joint"}).history.entries.empty());
  const auto seen = scene.call(bus::ReadObjectCommand{"joint", "virtual_inputs_seen"});
  EXPECT_THAT(seen.message, HasSubstr(" 6 "));
  level("0");
}

// 2017h:01 = 0, and all six of them by their objects.
TEST(NimotionVirtualInputs, DoNothingWhileTheyAreSwitchedOff) {
  Scene scene(
      loadText(familyJoint(kNimotionPp, withWrites(rawWrite("virtual_inputs_enabled", 0)))));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.inject("joint", "over_current");
  scene.run(200ms);
  const auto written = scene.call(bus::WriteObjectCommand{"joint", "virtual_inputs", "2"});
  EXPECT_TRUE(written.success) << written.message;
  scene.run(400ms);
  EXPECT_NE(scene.axis("joint").faultText(), "");
  const auto seen = scene.call(bus::ReadObjectCommand{"joint", "virtual_inputs_seen"});
  EXPECT_THAT(seen.message, HasSubstr(" 0 "));
}

TEST(NimotionVirtualInputs, HaveTheFunctionsOfTheFile) {
  FamilyScene scene(familyJoint(
      kNimotionPp,
      withWrites(terminalWrites("vdi1", 0, 0) + ", " + terminalWrites("vdi2", 38, 1) + ", " +
                 terminalWrites("vdi3", 2, 1) + ", " + terminalWrites("vdi4", 12, 0) + ", " +
                 terminalWrites("vdi5", 20, 1) + ", " + terminalWrites("vdi6", 33, 1))));
  const std::uint64_t wanted[] = {0, 0, 38, 1, 2, 1, 12, 0, 20, 1, 33, 1};
  for (std::uint8_t i = 0; i < 12; ++i) {
    EXPECT_EQ(scene.number(0x2017, static_cast<std::uint8_t>(3 + i)), wanted[i]) << int{i};
  }
  scene.inject("joint", "over_current");
  scene.run(200ms);
  const auto level = [&](const char* value) {
    const auto written = scene.call(bus::WriteObjectCommand{"joint", "virtual_inputs", value});
    EXPECT_TRUE(written.success) << written.message;
    scene.run(400ms);
  };
  level("4");  // VDI3
  EXPECT_EQ(scene.axis("joint").faultText(), "");
  EXPECT_FALSE(scene.call(bus::ErrorHistoryCommand{"joint"}).history.entries.empty());
  level("6");  // VDI2, too
  EXPECT_TRUE(scene.call(bus::ErrorHistoryCommand{"joint"}).history.entries.empty());
}

// What 1010h has saved of 607Ch is 0 again: the offset is the driver's.
TEST(NimotionHomeOffset, IsZeroInTheDriveAndCountedByTheDriver) {
  for (const char* saved : {"5000", "-5000"}) {
    Scene scene(loadText(familyJoint(
        kNimotionPp,
        ", homing: {method: 17, search_velocity: 0.4, zero_velocity: 0.05, acceleration: 2.0, "
        "offset: 0.3}, simulation: {lower_limit_switch: -0.4, with: {dictionary: [[0x607C, 0, "
        "home_offset, int32, rw, -, " +
            std::string(saved) + "]]}}" + kNimotionSwitches)));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
    ASSERT_TRUE(homed.success) << homed.message;
    EXPECT_EQ(scene.drive("joint").dictionary().find({0x607C, 0})->number, 0U);
    EXPECT_NEAR(scene.state("joint").position - scene.position("joint"), 0.3 + 0.4, 2e-3);
  }
}

std::string declaringZero(const std::string& more = {}) {
  return ", homing: {method: 35, offset: 0.7}" + more;
}

// 2B 17 20 02 00 ..., then 01 [2012-2013]; and low again.
TEST(NimotionSetHome, IsAnEdgeOfOneBitThatLeavesTheOthersAlone) {
  TracedScene scene(
      familyJoint(kNimotionPp, declaringZero(", simulation: {initial_position: 1.3}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  sim::Entry* levels = scene.drive("joint").dictionary().find({0x2017, 2});
  levels->number = 0x28;  // VDI4 and VDI6, which have no function
  scene.clear();
  scene.forget();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message;
  EXPECT_THAT(homed.message, AllOf(HasSubstr("method 35 (the present position)"),
                                   HasSubstr("position 0.700 rad"), HasSubstr("nothing moved")));
  EXPECT_TRUE(inOrder(scene.writes(), {"2B 17 20 02 28 00 00 00", "2B 17 20 02 29 00 00 00",
                                       "2B 17 20 02 28 00 00 00"}));
  EXPECT_EQ(levels->number, 0x28U);
  EXPECT_EQ(scene.seen("joint").travel(), 0.0);
  EXPECT_TRUE(scene.state("joint").homed);
  EXPECT_NEAR(scene.state("joint").position, 0.7, 1e-4);
  const auto counts =
      static_cast<std::int32_t>(scene.drive("joint").dictionary().find({0x6064, 0})->number);
  EXPECT_EQ(counts, 0) << "its own zero is here";
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.run(500ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4) << scene.told();
  ASSERT_EQ(scene.setpoint("joint", 0.9), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 1.5, 1e-3) << "0.2 rad on";
}

TEST(NimotionSetHome, IsRefusedWhileTheAxisIsEnabled) {
  FamilyScene scene(
      familyJoint(kNimotionPp, declaringZero(", simulation: {initial_position: 1.3}")));
  scene.forget();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, HasSubstr("disable it first"));
  EXPECT_LT(scene.seen("joint").travel(), 1e-4);
  EXPECT_FALSE(scene.state("joint").homed);
}

TEST(NimotionSetHome, IsRefusedWhereTheInputDoesSomethingElse) {
  for (const auto& [writes, told] :
       {std::pair(rawWrite("vdi1_function", 0), "vdi1_function (2017:03) is 0 instead of 33"),
        std::pair(rawWrite("vdi1_logic", 0), "vdi1_logic (2017:04) is 0 instead of 1"),
        std::pair(rawWrite("virtual_inputs_enabled", 0),
                  "virtual_inputs_enabled (2017:01) is 0 instead of 1")}) {
    Scene scene(loadText(familyJoint(kNimotionPp, declaringZero(withWrites(writes)))));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
    EXPECT_FALSE(homed.success);
    EXPECT_THAT(homed.message, HasSubstr(told));
    EXPECT_FALSE(scene.state("joint").homed);
  }
}

// A drive that takes the bit and does nothing.
TEST(NimotionSetHome, IsNoHomeWhereTheDriveGoesOnTellingAnotherPosition) {
  Scene scene(loadText(familyJoint(
      kNimotionPp,
      declaringZero(", simulation: {initial_position: 1.3, with: {terminals: {functions: "
                    "{set_home: 99}}}}"))));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  // 33 means nothing to this drive.
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_FALSE(homed.success) << homed.message;
  EXPECT_THAT(homed.message, HasSubstr("does not call the present position its zero"));
  EXPECT_FALSE(scene.state("joint").homed);
}

}  // namespace
}  // namespace cia402
