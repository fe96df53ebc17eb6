// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Terminals of the SV660C, what they are for, and the memory of its alarms.
#include "bus/canopen/history_command.h"
#include "bus/jobs/output_job.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

bus::Answer setSv660cOutput(Scene& scene, const std::string& name, bool on) {
  return scene.call(bus::SetOutputsCommand{"joint", {name}, {on}});
}

// Functions of DI and DO [L3904-3958, L4482-4536] and polarities, any time.
TEST(Sv660cTerminals, AreReadInWordsAndWritten) {
  Sv660cReady scene;
  for (const auto& [object, told] :
       {std::pair("di1_function", " is 14 (0x000E): forward limit switch"),
        std::pair("di3_function", " is 13 (0x000D): position command inhibit"),
        std::pair("di4_function", " is 2 (0x0002): alarm reset"),
        std::pair("di5_function", " is 1 (0x0001): servo enable"),
        std::pair("di8_function", " is 31 (0x001F): home switch"),
        std::pair("di9_function", " is 0 (0x0000): none"),
        std::pair("do1_function", " is 1 (0x0001): servo ready"),
        std::pair("do2_function", " is 5 (0x0005): in position"),
        std::pair("do3_function", " is 9 (0x0009): holding brake"),
        std::pair("do4_function", " is 11 (0x000B): fault"),
        std::pair("do5_function", " is 16 (0x0010): homed")}) {
    EXPECT_THAT(sv660cRead(scene, object).message, testing::EndsWith(told)) << object;
  }
  EXPECT_TRUE(sv660cWrite(scene, "di3_function", "0").success);
  EXPECT_EQ(sv660cNumber(scene, 0x2003, 7), 0U);
  EXPECT_TRUE(sv660cWrite(scene, "di9_function", "38").success);
  EXPECT_THAT(sv660cRead(scene, "H03.18").message, HasSubstr("touch probe 1"));
  EXPECT_TRUE(sv660cWrite(scene, "di9_active_high", "1").success);
  EXPECT_EQ(sv660cNumber(scene, 0x2003, 0x14), 1U);
}

TEST(Sv660cTerminals, LeaveTheBrakeItsOwn) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  for (const char* name : {"do3_function", "H04.04", "2004:05"}) {
    const bus::Answer written = sv660cWrite(scene, name, "31");
    EXPECT_FALSE(written.success) << name;
    EXPECT_THAT(written.message, HasSubstr("do3_function"));
  }
  EXPECT_EQ(sv660cNumber(scene, 0x2004, 5), 9U);
}

// 60FEh is shown where the function is 31 [L1806, L16233].
TEST(Sv660cOutputs, AreSetWhereTheTerminalShowsThem) {
  Scene scene(loadText(sv660cWrites("{object: do1_function, raw: 31}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_TRUE(setSv660cOutput(scene, "do1", true).success);
  EXPECT_EQ(scene.truth("joint").outputs, 0x10000U);
  const bus::Answer refused = setSv660cOutput(scene, "do2", true);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("the terminal of do2 shows something else: do2_function "
                                         "(2004:03) is 5 (in position), not 31"));
  EXPECT_EQ(sv660cNumber(scene, 0x60FE, 1), 0x10000U) << "nothing was written";
  EXPECT_TRUE(setSv660cOutput(scene, "do1", false).success);
  EXPECT_EQ(scene.truth("joint").outputs, 0U);
}

// H04.22 and H31.04, whatever the function is; H04.22 while stopped only [L4700-4724].
TEST(Sv660cOutputs, AreSetByParameterWhereTheyShowSomethingElse) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_TRUE(setSv660cOutput(scene, "do4 by parameter", true).success);
  EXPECT_EQ(scene.truth("joint").outputs, 0x80000U);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  EXPECT_TRUE(setSv660cOutput(scene, "do4 by parameter", false).success) << "its mask is open";
  EXPECT_EQ(scene.truth("joint").outputs, 0U);
  const bus::Answer refused = setSv660cOutput(scene, "do5 by parameter", true);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("0x08000022"));
}

// H04.23: kept, or off, while the node is not operational [L4728-4754].
TEST(Sv660cOutputs, OutOfOperationAreAsTheRobotsFileSays) {
  for (const auto& [offline, kept] : {std::pair("0", 0x30000U), std::pair("1", 0x20000U)}) {
    Scene scene(
        loadText(sv660cWrites("{object: do1_function, raw: 31}, {object: do2_function, raw: 31}, "
                              "{object: outputs_offline, raw: " +
                              std::string(offline) + "}")));
    ASSERT_TRUE(scene.boot()) << scene.told();
    EXPECT_TRUE(setSv660cOutput(scene, "do1", true).success);
    EXPECT_TRUE(setSv660cOutput(scene, "do2", true).success);
    ASSERT_EQ(scene.truth("joint").outputs, 0x30000U);
    EXPECT_TRUE(scene.call(bus::NmtServiceCommand{"joint", "pre_operational"}).success);
    scene.run(20ms);
    EXPECT_EQ(scene.truth("joint").outputs, kept) << offline;
  }
}

// H0b.33 selects, H0b.34 and H0b.35 show; the newest first [L8619-8695].
TEST(Sv660cAlarms, OfThePastAreToldTheNewestFirst) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto none = scene.call(bus::ErrorHistoryCommand{"joint"});
  EXPECT_TRUE(none.success) << none.message;
  EXPECT_THAT(none.message, HasSubstr("alarms (alarm_code (200B:23)): empty"));
  for (const char* fault : {"overspeed", "position_command", "motor_overload"}) {
    scene.inject("joint", fault);
    scene.run(2s);
    scene.inject("joint", "clear");
    EXPECT_TRUE(scene.procedure(ProcedureKind::clear_faults, "joint").success) << scene.told();
  }
  const auto history = scene.call(bus::ErrorHistoryCommand{"joint"});
  EXPECT_TRUE(history.success) << history.message;
  ASSERT_EQ(history.history.entries.size(), 3U);
  const std::uint16_t codes[] = {0x620, 0xB01, 0x500};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(history.history.entries[i].code, codes[i]) << i;
  const double between = *history.history.entries[1].time - *history.history.entries[2].time;
  EXPECT_GT(between, 2.0);
  EXPECT_LT(between, 6.0);
  EXPECT_THAT(history.message, AllOf(HasSubstr("E620 motor overload at "),
                                     HasSubstr(" s, EB01 position commands at "),
                                     HasSubstr(" s, E500 over speed at ")));
  EXPECT_EQ(sv660cNumber(scene, 0x200B, 0x22), 0U) << "the newest is selected again";
}

TEST(Sv660cAlarms, AreTwentyAndStayWithoutPower) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  for (int i = 0; i < 12; ++i) {
    scene.inject("joint", "overload_warning");
    scene.inject("joint", "phase_loss_warning");
    scene.inject("joint", "clear");
  }
  scene.inject("joint", "power_cycle");
  scene.run(4s);
  const auto history = scene.call(bus::ErrorHistoryCommand{"joint"});
  ASSERT_EQ(history.history.entries.size(), 20U) << history.message;
  EXPECT_EQ(history.history.entries[0].code, 0x990);
  EXPECT_EQ(history.history.entries[19].code, 0x909);
  EXPECT_EQ(sv660cNumber(scene, 0x200B, 0x22), 0U) << "the newest is selected again";
}

TEST(Sv660cAlarms, ThatCannotBeReadAreToldAsSuch) {
  Scene scene(loadText(sv660cJoint({}, sv660cDelivered("[0x200B, 0x22, sel, uint16, ro, -, 0]"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto history = scene.call(bus::ErrorHistoryCommand{"joint"});
  EXPECT_FALSE(history.success);
  EXPECT_THAT(history.message, HasSubstr("alarm 0 not read"));
}

}  // namespace
}  // namespace cia402
