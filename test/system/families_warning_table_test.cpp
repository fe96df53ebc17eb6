// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every warning of each family, and the limit switches: what is told, what goes on, and the way off
// a switch. What the joint does is read from the motor.
#include "system/families_faults.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::HasSubstr;

/// A warning as its maker's manual has it.
struct FamilyCaution {
  const char *name, *code, *words;
  bool holds;  ///< the motor pauses, and may go on by itself once the cause is gone
};
struct FamilyCautions {
  FamilyMode tested;
  std::vector<FamilyCaution> warnings;
};
void PrintTo(const FamilyCautions& cautions, std::ostream* out) { *out << cautions.tested.family; }

class FamilyWarningTable : public testing::TestWithParam<FamilyCautions> {};

TEST_P(FamilyWarningTable, HasAllThatTheSimulatedDriveHas) {
  std::set<std::string> listed;
  for (const FamilyCaution& caution : GetParam().warnings) listed.insert(caution.name);
  EXPECT_EQ(alarmNames(*familyDefinition(GetParam().tested.family), true), listed);
}

TEST_P(FamilyWarningTable, IsToldInWordsAndTheMotionGoesOnOrIsGivenUp) {
  FamilyScene scene(familyJoint(GetParam().tested));
  double direction = 1.0;
  for (const FamilyCaution& caution : GetParam().warnings) {
    scene.sendOff(direction);
    scene.inject("joint", caution.name);
    scene.run(50ms);
    EXPECT_THAT(scene.axis("joint").faultText() + scene.told(),
                AllOf(HasSubstr(caution.code), HasSubstr(caution.words)))
        << caution.name;
    scene.run(400ms);
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << caution.name;
    EXPECT_EQ(scene.state("joint").halted, caution.holds) << caution.name << scene.told();
    if (caution.holds) {
      EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << caution.name;
    } else {
      EXPECT_GT(direction * scene.velocity("joint"), 0.3) << caution.name;
      scene.mustSucceed(ProcedureKind::halt);
    }
    scene.inject("joint", "clear");
    scene.expectStands(500ms, 2e-3);
    EXPECT_FALSE(scene.state("joint").warning) << caution.name;
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << caution.name << scene.told();
    EXPECT_EQ(scene.axis("joint").faultText(), "") << caution.name;
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(300ms, 2e-3);
    direction = -direction;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, FamilyWarningTable,
    testing::Values(
        // [2121-2175]: reaction 3 pauses, 4 stops at the limit
        FamilyCautions{{kNimotionStepper, "4000", "csp"},
                       {{"eeprom_self_check", "0xFF04", "EEPROM self test failed", true},
                        {"stall", "0x7121", "motor stalled", true},
                        {"terminal_setup", "0x6320", "inputs are set up wrongly", true},
                        {"negative_limit_switch", "0xFF0E", "negative limit switch", true},
                        {"positive_limit_switch", "0xFF0F", "positive limit switch", true},
                        {"position_limit", "0xFF10", "position limit of the drive", true}}},
        // L532-542
        FamilyCautions{{kId286Cnfa, "10000", "pp"},
                       {{"eeprom_read_warning", "0x0100", "parameter memory not read", false},
                        {"voltage_warning", "0x0200", "supply voltage unsteady", false},
                        {"emergency_stop_warning", "0x0400", "emergency stop", false},
                        {"positive_limit_switch", "0x0800", "positive limit", false},
                        {"negative_limit_switch", "0x1000", "negative limit", false},
                        {"positive_position_limit", "0x0800", "positive limit", false},
                        {"negative_position_limit", "0x1000", "negative limit", false},
                        {"homing_failed", "0x2000", "homing failed", false}}},
        // L1396-1400, L8048, L8189, L8205, L7853
        FamilyCautions{{kSv660c, "100000", "ip"},
                       {{"homing_time", "0xFF00", "E601 homing took too long", false},
                        {"overload_warning", "0x3230", "E909 motor overload ahead", false},
                        {"forward_limit", "0x8612", "E950 forward position limit", false},
                        {"reverse_limit", "0x8612", "E952 reverse position limit", false},
                        {"phase_loss_warning", "0x3130", "E990 phase of the mains", false}}},
        // L3797-3815
        FamilyCautions{
            {kMegmeetDm5, "8388608", "csp"},
            {{"motor_overload_warning", "0xFF0C", "motor overload ahead (AL.012)", false},
             {"serial_link_warning", "0xFF0E", "serial link failed (AL.014)", false},
             {"temperature_sensor_warning", "0xFF19", "temperature sensing broken (AL.025)", false},
             {"emergency_stop_warning", "0xFF26", "emergency stop input (AL.038)", true},
             {"positive_limit_warning", "0xFF27", "forward limit switch (AL.039)", true},
             {"negative_limit_warning", "0xFF28", "reverse limit switch (AL.040)", true},
             {"interrupt_feed_warning", "0xFF3E", "interrupt feed (AL.062)", false},
             {"battery_warning", "0xFF4B", "encoder battery low (AL.075)", false}}}),
    [](const auto& tested) { return std::string(tested.param.tested.family); });

/// A drive that runs onto a limit switch.
struct OnSwitch {
  FamilyMode tested;
  const char* name;
  const char *upper, *lower;  ///< what is told
  bool faults;                ///< its power goes
  const char* more = "";      ///< options of the axis
};
void PrintTo(const OnSwitch& tested, std::ostream* out) { *out << tested.name; }

class FamilyLimitSwitch : public testing::TestWithParam<OnSwitch> {
 protected:
  static void goOn(FamilyScene& scene, double direction) {
    const bool goal = scene.kind() == ControlKind::position;
    for (int i = 0; i < 100; ++i) {
      (void)scene.setpoint("joint", goal ? 1.6 * direction : 0.5 * direction);
      scene.run(20ms);
      if (goal) break;
    }
    scene.run(2s);
  }
};

TEST_P(FamilyLimitSwitch, StopsTheJointIsToldAndIsLeftTheOtherWay) {
  for (const double side : {1.0, -1.0}) {
    FamilyScene scene(familyJoint(
        GetParam().tested, ", simulation: {upper_limit_switch: 0.5, lower_limit_switch: -0.5}" +
                               std::string(GetParam().more)));
    goOn(scene, side);
    EXPECT_THAT(scene.told() + scene.axis("joint").faultText(),
                HasSubstr(side > 0.0 ? GetParam().upper : GetParam().lower));
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
    EXPECT_GT(side * scene.position("joint"), 0.5);
    // 0.8 rad/s end by 6085h of 8 rad/s^2 within 0.04 rad, or by 4 rad/s^2 within 0.08.
    EXPECT_LT(side * scene.position("joint"), 0.5 + 0.1) << scene.told();
    EXPECT_EQ(scene.truth("joint").power_stage_on, !GetParam().faults);
    if (GetParam().faults) scene.mustSucceed(ProcedureKind::clear_faults);
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(500ms);
    if (scene.kind() == ControlKind::position) {
      EXPECT_EQ(scene.setpoint("joint", 0.0), "");
      scene.run(3s);
      EXPECT_NEAR(scene.position("joint"), 0.0, 1e-3) << scene.told();
    } else {
      scene.stream("joint", -0.4 * side, 1s);
      EXPECT_LT(side * scene.position("joint"), 0.4) << scene.told();
      scene.run(1s);
    }
    EXPECT_FALSE(scene.state("joint").warning);
    EXPECT_EQ(scene.axis("joint").faultText(), "");
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << scene.told();
  }
}

// P03.00 and P03.03, and P10.04.
constexpr char kOvertravelFaults[] =
    ", write: [{object: di1_function, raw: 36}, {object: overtravel_action, raw: 0}]";
constexpr char kOvertravelWarns[] =
    ", write: [{object: di1_function, raw: 36}, {object: overtravel_action, raw: 1}]";

INSTANTIATE_TEST_SUITE_P(
    All, FamilyLimitSwitch,
    testing::Values(
        OnSwitch{{kNimotionStepper, "4000", "csp"},
                 "NimotionCsp",
                 "0xFF0F",
                 "0xFF0E",
                 false,
                 kNimotionSwitches},
        OnSwitch{{kNimotionStepper, "4000", "pp"},
                 "NimotionPp",
                 "0xFF0F",
                 "0xFF0E",
                 false,
                 kNimotionSwitches},
        OnSwitch{{kNimotionStepper, "4000", "pv"},
                 "NimotionPv",
                 "0xFF0F",
                 "0xFF0E",
                 false,
                 kNimotionSwitches},
        OnSwitch{{kNimotionStepper, "4000", "ip"},
                 "NimotionIp",
                 "0xFF0F",
                 "0xFF0E",
                 false,
                 kNimotionSwitches},
        OnSwitch{{kId286Cnfa, "10000", "pp"}, "Id286Pp", "0x0800", "0x1000", false},
        OnSwitch{{kId286Cnfa, "10000", "pv"}, "Id286Pv", "0x0800", "0x1000", false},
        OnSwitch{
            {kMegmeetDm5, "8388608", "pp"}, "Dm5Pp", "0xFF27", "0xFF28", true, kOvertravelFaults},
        OnSwitch{
            {kMegmeetDm5, "8388608", "pv"}, "Dm5Pv", "0xFF27", "0xFF28", true, kOvertravelFaults},
        OnSwitch{
            {kMegmeetDm5, "8388608", "csp"}, "Dm5Csp", "0xFF27", "0xFF28", true, kOvertravelFaults},
        OnSwitch{
            {kMegmeetDm5, "8388608", "csv"}, "Dm5Csv", "0xFF27", "0xFF28", true, kOvertravelFaults},
        OnSwitch{{kMegmeetDm5, "8388608", "pp"},
                 "Dm5PpWarns",
                 "0xFF27",
                 "0xFF28",
                 false,
                 kOvertravelWarns},
        OnSwitch{{kMegmeetDm5, "8388608", "pv"},
                 "Dm5PvWarns",
                 "0xFF27",
                 "0xFF28",
                 false,
                 kOvertravelWarns},
        OnSwitch{{kMegmeetDm5, "8388608", "csp"},
                 "Dm5CspWarns",
                 "0xFF27",
                 "0xFF28",
                 false,
                 kOvertravelWarns},
        OnSwitch{{kMegmeetDm5, "8388608", "csv"},
                 "Dm5CsvWarns",
                 "0xFF27",
                 "0xFF28",
                 false,
                 kOvertravelWarns}),
    [](const auto& tested) { return std::string(tested.param.name); });

// Bytes 4 to 7 are the word of 200Eh: code, whether it ends by itself, reaction [294-304,
// 2137-2175].
TEST(NimotionAlarms, TellTheRegisterAndTheWordOfTheirEmergency) {
  FamilyScene scene(familyJoint({kNimotionStepper, "4000", "csp"}));
  for (const FamilyAlarm& alarm : nimotionFaults()) {
    const auto code = static_cast<std::uint16_t>(std::stoul(alarm.code, nullptr, 16));
    const std::uint8_t ends = alarm.ends == Ends::by_itself ? 1 : 0;
    const std::uint8_t reaction = alarm.ends == Ends::by_power_cycle ? 1 : 0;
    scene.inject("joint", alarm.name);
    scene.run(20ms);
    const fieldbus::Emergency& emergency = scene.robot().emergencies().back().emergency;
    EXPECT_EQ(emergency.code, code) << alarm.name;
    EXPECT_THAT(emergency.vendor, testing::ElementsAre(0, code & 0xFF, code >> 8, ends, reaction))
        << alarm.name;
    EXPECT_EQ(emergency.error_register & 1, 1) << alarm.name;
    if (alarm.ends == Ends::by_power_cycle) break;
    scene.run(1500ms);
    scene.mustSucceed(ProcedureKind::clear_faults);
    EXPECT_EQ(scene.robot().emergencies().back().emergency.code, 0) << alarm.name;
  }
  EXPECT_THAT(scene.told(), HasSubstr("emergency: 0x3110 over voltage: the bus is above"));
  EXPECT_THAT(scene.told(),
              HasSubstr("error register: generic, voltage; manufacturer bytes: 00 10 31 01 00"));
}

// Its emergency comes and goes before a TPDO has brought the code, or in between.
TEST(NimotionAlarms, ThatPauseForAMomentHaltTheAxisWhichStaysEnabled) {
  for (int ms = 5; ms < 60; ms += 2) {
    FamilyScene scene(familyJoint({kNimotionStepper, "4000", "csp"}));
    scene.sendOff();
    scene.inject("joint", "stall");
    scene.run(std::chrono::milliseconds(ms));
    scene.inject("joint", "clear");
    scene.run(1s);
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << ms << " ms\n" << scene.told();
    EXPECT_TRUE(scene.state("joint").halted) << ms << " ms\n" << scene.told();
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << ms << " ms";
  }
}

/// Alarms of the NiMotion that end by themselves once their cause is gone [2112-2141]: nothing goes
/// on.
TEST(NimotionAlarms, ThatEndByThemselvesLeaveItDisabled) {
  for (const FamilyAlarm& alarm : nimotionFaults()) {
    if (alarm.ends != Ends::by_itself) continue;
    FamilyScene scene(familyJoint({kNimotionStepper, "4000", "pv"}));
    scene.sendOff();
    scene.inject("joint", alarm.name);
    scene.run(100ms);
    EXPECT_EQ(scene.state("joint").state, State::fault) << alarm.name;
    EXPECT_THAT(scene.axis("joint").faultText(),
                HasSubstr("it ends by itself once its cause is gone, then enable"));
    ASSERT_TRUE(
        scene.runUntil([&] { return scene.state("joint").state == State::switch_on_disabled; }, 2s))
        << alarm.name;
    EXPECT_NE(scene.setpoint("joint", 0.5), "") << alarm.name;
    scene.expectStands(500ms, 0.5);  // it coasts
    EXPECT_FALSE(scene.truth("joint").power_stage_on) << alarm.name;
    EXPECT_EQ(scene.axis("joint").faultText(), "") << alarm.name;
    scene.run(1s);
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(500ms);
  }
}

}  // namespace
}  // namespace cia402
