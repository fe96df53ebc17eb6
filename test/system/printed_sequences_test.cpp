// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The examples of the NiMotion's manual, which it prints as objects and their values in an order:
// the simulated drive gets them as frames, and the driver sends those. Numbers in brackets are
// lines of that manual.
#include "bus/jobs/output_job.h"
#include "system/damiao_scene.h"
#include "system/families_motion.h"
#include "system/printed_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using sim::ms;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr char kPrintedStepper[] = "nimotion_stepper";
constexpr double kPrintedTurn = 6.283185307179586;  // rad of an axis without a gear

/// Limits of an axis, in turns/s and turns/s^2.
struct PrintedLimits {
  double velocity, acceleration;
};

/// A NiMotion without a gear all of whose objects travel by SDO; 4000 counts/s are a turn a second.
std::string printedJoint(const std::string& mode, const PrintedLimits& limits,
                         const std::string& more = {}) {
  std::ostringstream text;
  text.precision(17);
  text << "  joint: {node_id: 1, drive: nimotion_stepper, counts_per_turn: 4000, gear_ratio: 1.0, "
          "rated_torque: 1.27, unwatched_streams: true, pdos: none, mode: "
       << mode << ", modes: [" << mode << "],\n    limits: {lower: -500.0, upper: 500.0, velocity: "
       << limits.velocity * kPrintedTurn << ", acceleration: " << limits.acceleration * kPrintedTurn
       << ", effort: 1.0}" << more << "}\n";
  return busRobot(text.str());
}

/// What the drive holds before the driver comes, which writes only what is not so yet.
std::string printedRows(const std::string& rows, const std::string& more = {}) {
  return ", simulation: {" + more + "with: {dictionary: [" + rows + "]}}";
}
constexpr char kOtherControlMode[] = "[0x2002, 1, CtrlModeSelec, uint16, rw, -, 2]";

/// Such an axis, booted; what it writes from the first moment on is kept.
struct PrintedAxis : TracedScene {
  explicit PrintedAxis(const std::string& yaml) : TracedScene(yaml) {
    EXPECT_TRUE(boot(kFamilyBoot)) << told();
  }
  void enable() {
    const bus::Answer enabled = procedure(ProcedureKind::enable);
    EXPECT_TRUE(enabled.success) << enabled.message;
  }
};

// Three turns of the motor are one of the shaft, 4000 counts of 6064h [679-693].
TEST(NimotionPrintedGear, TurnsTheShaftByATurnOfItsEncoder) {
  PrintedDrive drive(kPrintedStepper);
  drive.take({"23 8F 60 01 A0 0F 00 00", "23 8F 60 02 01 00 00 00", "23 91 60 01 03 00 00 00",
              "23 91 60 02 01 00 00 00", "2F 60 60 00 01 00 00 00", "23 7A 60 00 A0 0F 00 00",
              "2B 40 60 00 06 00 00 00", "2B 40 60 00 07 00 00 00", "2B 40 60 00 0F 00 00 00",
              "2B 40 60 00 1F 00 00 00"});
  drive.run(ms(4000));
  EXPECT_NEAR(drive.turns(), 3.0, 1e-3);
  EXPECT_EQ(drive.position(), 4000);
  EXPECT_NEAR(static_cast<std::int32_t>(drive.read(0x6063)), 12000, 3);
  PrintedAxis scene(replaced(
      replaced(printedJoint("pp", {2.0, 10.0},
                            ", write: [{object: encoder_increments, raw: 4000}, {object: "
                            "encoder_revolutions, raw: 1}, {object: gear_motor_revolutions, raw: "
                            "3}, {object: gear_shaft_revolutions, raw: 1}]" +
                                printedRows("[0x608F, 1, increments, uint32, rw, -, 1000], "
                                            "[0x608F, 2, revolutions, uint32, rw, -, 9], "
                                            "[0x6091, 2, shaft, uint32, rw, -, 9]")),
               "gear_ratio: 1.0", "gear_ratio: 3.0"),
      "counts_per_turn: 4000", "counts_per_turn: 1333.3333333333333"));
  EXPECT_TRUE(inOrder(scene.writes(), {"23 8F 60 01 A0 0F 00 00", "23 8F 60 02 01 00 00 00",
                                       "23 91 60 01 03 00 00 00", "23 91 60 02 01 00 00 00"}));
  scene.enable();
  ASSERT_EQ(scene.setpoint("joint", kPrintedTurn), "");
  scene.run(3s);
  EXPECT_THAT(scene.writes(), Contains("23 7A 60 00 A0 0F 00 00")) << "a turn of the joint";
  EXPECT_NEAR(scene.truth("joint").position_turns, 3.0, 1e-3);
}

// 300 rpm by 500 rpm/s [1007-1015]. The driver sees "operation enabled" before it asks for a
// motion.
TEST(NimotionPrintedVelocityMode, TurnsAt300Rpm) {
  PrintedDrive drive(kPrintedStepper);
  drive.take({"2B 02 20 01 00 00 00 00", "2F 60 60 00 02 00 00 00", "2B 42 60 00 2C 01 00 00",
              "23 48 60 01 F4 01 00 00", "2B 48 60 02 01 00 00 00", "23 49 60 01 F4 01 00 00",
              "2B 49 60 02 01 00 00 00", "2B 40 60 00 06 00 00 00", "2B 40 60 00 07 00 00 00",
              "2B 40 60 00 7F 00 00 00"});
  drive.run(ms(300));
  EXPECT_NEAR(drive.speed(), 2.5, 0.1) << "500 rpm in a second";
  drive.run(ms(700));
  EXPECT_NEAR(drive.speed(), 5.0, 0.01) << "300 rpm";
  PrintedAxis scene(printedJoint("vl", {8.0, 500.0 / 60.0}, printedRows(kOtherControlMode)));
  scene.enable();
  scene.stream("joint", 5.0 * kPrintedTurn, 1500ms);
  EXPECT_NEAR(scene.truth("joint").velocity_turns, 5.0, 0.01);
  EXPECT_TRUE(inOrder(scene.writes(), {"2B 02 20 01 00 00 00 00", "23 48 60 01 F4 01 00 00",
                                       "2B 48 60 02 01 00 00 00", "23 49 60 01 F4 01 00 00",
                                       "2B 49 60 02 01 00 00 00", "2F 60 60 00 02 00 00 00",
                                       "2B 42 60 00 2C 01 00 00"}));
  EXPECT_THAT(printedWords(scene, 4), ElementsAre("06", "07", "0F", "7F"));
}

// 4000 counts/s by 40000 counts/s^2 [1092-1106]
TEST(NimotionPrintedProfileVelocity, TurnsOnceASecond) {
  PrintedDrive drive(kPrintedStepper);
  drive.take({"2B 02 20 01 00 00 00 00", "2F 60 60 00 03 00 00 00", "23 FF 60 00 A0 0F 00 00",
              "23 83 60 00 40 9C 00 00", "23 84 60 00 40 9C 00 00", "2B 40 60 00 06 00 00 00",
              "2B 40 60 00 07 00 00 00"});
  EXPECT_EQ(drive.speed(), 0.0);
  drive.take({"2B 40 60 00 0F 00 00 00"});
  drive.run(ms(50));
  EXPECT_NEAR(drive.speed(), 0.5, 0.06) << "10 turns/s^2";
  drive.run(ms(450));
  EXPECT_NEAR(drive.speed(), 1.0, 0.002);
  PrintedAxis scene(printedJoint("pv", {2.0, 10.0},
                                 printedRows(std::string(kOtherControlMode) +
                                             ", [0x6083, 0, acceleration, uint32, rw, -, 1]")));
  scene.enable();
  scene.stream("joint", kPrintedTurn, 500ms);
  EXPECT_NEAR(scene.truth("joint").velocity_turns, 1.0, 0.002);
  EXPECT_TRUE(inOrder(scene.writes(), {"2B 02 20 01 00 00 00 00", "23 83 60 00 40 9C 00 00",
                                       "23 84 60 00 40 9C 00 00", "2F 60 60 00 03 00 00 00",
                                       "23 FF 60 00 A0 0F 00 00"}));
  EXPECT_THAT(printedWords(scene, 3), ElementsAre("06", "07", "0F"));
}

// Method 17 by 16000 and 4000 counts/s, 32000 counts/s^2; DI0 is the negative limit, active low
// [1354-1364]. Its logic is printed as 2003h:04, which is that of DI1.
TEST(NimotionPrintedHoming, FindsTheNegativeLimitSwitch) {
  sim::AxisMechanics mechanics;
  mechanics.negative_limit_switch = -3.0;
  PrintedDrive drive(kPrintedStepper, mechanics);
  drive.take({"2B 02 20 01 00 00 00 00", "2F 60 60 00 06 00 00 00", "2F 98 60 00 11 00 00 00",
              "23 99 60 01 80 3E 00 00", "23 99 60 02 A0 0F 00 00", "23 9A 60 00 00 7D 00 00",
              "2B 03 20 01 0F 00 00 00", "2B 03 20 02 00 00 00 00", "2B 40 60 00 06 00 00 00",
              "2B 40 60 00 07 00 00 00", "2B 40 60 00 1F 00 00 00"});
  drive.run(ms(600));
  EXPECT_NEAR(drive.speed(), -4.0, 0.02);
  drive.run(ms(3000));
  EXPECT_EQ(drive.speed(), 0.0);
  EXPECT_EQ(drive.status() & 0x3400, 0x1400) << "attained, and no error";
  EXPECT_NEAR(drive.turns() - drive.position() / 4000.0, -3.0, 0.006) << "4 turns/s for a ms or so";
  PrintedAxis scene(printedJoint(
      "pp", {6.0, 20.0},
      ", homing: {method: 17, search_velocity: 25.132741228718345, zero_velocity: "
      "6.283185307179586, acceleration: 50.26548245743669}, write: [{object: di0_function, raw: "
      "15}, {object: di0_logic, raw: 0}]" +
          printedRows("[0x2003, 2, DI0LogicSelec, uint16, rw, r, 1]",
                      "lower_limit_switch: -18.85, ")));
  EXPECT_TRUE(inOrder(scene.writes(), {"2B 03 20 01 0F 00 00 00", "2B 03 20 02 00 00 00 00"}));
  scene.clear();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_TRUE(homed.success) << homed.message;
  EXPECT_TRUE(inOrder(scene.writes(), {"2F 98 60 00 11 00 00 00", "23 99 60 01 80 3E 00 00",
                                       "23 99 60 02 A0 0F 00 00", "23 9A 60 00 00 7D 00 00"}));
  EXPECT_THAT(scene.writes(), Contains("2F 60 60 00 06 00 00 00"));
  EXPECT_TRUE(inOrder(printedWords(scene, 100), {"06", "07", "0F", "1F"}));
  EXPECT_NEAR(scene.position("joint") - scene.state("joint").position, -18.85, 0.04);
}

// 20 ms [1443-1455]; positions are absolute. 40 counts in 20 ms are half a turn a second.
TEST(NimotionPrintedInterpolation, FollowsAPositionEach20Milliseconds) {
  PrintedDrive drive(kPrintedStepper);
  drive.take({"2B 02 20 01 00 00 00 00", "2F 60 60 00 07 00 00 00", "2F C2 60 01 14 00 00 00",
              "2F C2 60 02 FD 00 00 00", "2B 40 60 00 06 00 00 00", "2B 40 60 00 07 00 00 00",
              "2B 40 60 00 0F 00 00 00"});
  EXPECT_EQ(drive.status() & 0x1000, 0) << "interpolation is not active";
  drive.take({"2B 40 60 00 1F 00 00 00"});
  EXPECT_EQ(drive.status() & 0x1000, 0x1000);
  for (std::uint32_t counts = 40; counts <= 2000; counts += 40) {
    const Time next = drive.now + 20ms;
    drive.write(0x60C1, 1, counts, 4);
    drive.run(next - drive.now);
  }
  EXPECT_NEAR(drive.speed(), 0.5, 0.05);
  drive.run(ms(200));
  EXPECT_EQ(drive.position(), 2000);
  BusOptions bus;
  bus.period = "0.02";
  TracedScene scene(busRobot(
      busAxis(nimotionIn("ip"), "joint", 1,
              printedRows(std::string(kOtherControlMode) +
                          ", [0x60C2, 1, period, uint8, rw, -, 10], [0x60C2, 2, index, int8, rw, "
                          "-, -4]")),
      bus));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_TRUE(inOrder(scene.writes(), {"2B 02 20 01 00 00 00 00", "2F C2 60 01 14 00 00 00",
                                       "2F C2 60 02 FD 00 00 00"}));
  scene.run(300ms);
  scene.clear();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  scene.run(100ms);
  EXPECT_THAT(scene.writes(), Contains("2F 60 60 00 07 00 00 00"));
  EXPECT_THAT(commandsSeen(scene, 1), ElementsAre("06@40", "07@21", "0F@23", "1F@27"));
  expectGoes(scene, 0.3);
}

// csp [1522-1526] and csv [1575-1583]
TEST(NimotionPrintedCyclicModes, FollowTheirTargets) {
  for (const bool positions : {true, false}) {
    PrintedDrive drive(kPrintedStepper);
    drive.take({"2B 02 20 01 00 00 00 00",
                positions ? "2F 60 60 00 08 00 00 00" : "2F 60 60 00 09 00 00 00",
                "2B 40 60 00 06 00 00 00", "2B 40 60 00 07 00 00 00", "2B 40 60 00 0F 00 00 00"});
    for (std::uint32_t counts = 40; counts <= 2000; counts += 40) {
      const Time next = drive.now + 20ms;
      drive.write(positions ? 0x607A : 0x60FF, 0, counts, 4);
      drive.run(next - drive.now);
    }
    drive.run(ms(100));
    if (positions) {
      EXPECT_EQ(drive.position(), 2000);
    } else {
      EXPECT_NEAR(drive.speed(), 0.5, 0.002) << "2000 counts/s";
    }
    TracedScene scene(
        busJoint(nimotionIn(positions ? "csp" : "csv"), printedRows(kOtherControlMode)));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    EXPECT_THAT(scene.writes(), Contains("2B 02 20 01 00 00 00 00"));
    scene.run(300ms);
    scene.clear();
    ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
    EXPECT_THAT(scene.writes(),
                Contains(positions ? "2F 60 60 00 08 00 00 00" : "2F 60 60 00 09 00 00 00"));
    EXPECT_THAT(commandsSeen(scene, 1), ElementsAre("06@40", "07@21", "0F@23"));
  }
}

/// A drive whose inputs DI0 and DI2 are high.
struct PrintedTerminals : PrintedDrive {
  PrintedTerminals() : PrintedDrive(kPrintedStepper) {
    input(0, true);
    input(2, true);
  }
  void input(unsigned bit, bool high) {
    drive->setInput(bit, high, now);
    run(ms(500));
  }
};

// A step of 50 increments for each rising edge of DI1, while DI0 is low [1638-1652].
TEST(NimotionPrintedSteps, AreMadeByTheEdgesOfDi1) {
  PrintedTerminals drive;
  drive.take({"2B 02 20 01 01 00 00 00", "23 05 20 02 32 00 00 00", "2B 03 20 01 01 00 00 00",
              "2B 03 20 02 00 00 00 00", "2B 03 20 03 14 00 00 00", "2B 03 20 04 02 00 00 00"});
  drive.input(1, true);
  EXPECT_EQ(drive.position(), 0) << "DI0 is high";
  drive.input(1, false);
  drive.input(0, false);
  EXPECT_TRUE(drive.powered());
  for (const int position : {50, 100}) {
    drive.input(1, true);
    EXPECT_EQ(drive.position(), position);
    drive.input(1, false);
    EXPECT_EQ(drive.position(), position);
  }
}

// 120 rpm by 2006h:02, from 0 to 1000 rpm in 200 ms [1709-1728]
TEST(NimotionPrintedMakersSpeed, IsThatOfItsObject) {
  PrintedTerminals drive;
  drive.take({"2B 02 20 01 02 00 00 00", "2B 06 20 01 00 00 00 00", "2B 06 20 03 C8 00 00 00",
              "2B 06 20 04 C8 00 00 00", "2B 06 20 02 78 00 00 00", "2B 03 20 01 01 00 00 00",
              "2B 03 20 02 00 00 00 00"});
  EXPECT_FALSE(drive.powered());
  drive.input(0, false);
  EXPECT_NEAR(drive.speed(), 2.0, 0.002);
  drive.input(0, true);
  EXPECT_FALSE(drive.powered());
}

// By the pulse width at DI0, whose share 200Bh:07 shows; DI1 the direction, DI2 enables
// [1730-1763].
TEST(NimotionPrintedMakersSpeed, IsThatOfAPulseWidth) {
  PrintedTerminals drive;
  drive.take({"2B 02 20 01 02 00 00 00", "2B 06 20 01 03 00 00 00", "2B 06 20 03 64 00 00 00",
              "2B 06 20 04 64 00 00 00", "2B 03 20 01 2C 00 00 00", "2B 03 20 02 00 00 00 00",
              "2B 03 20 03 2D 00 00 00", "2B 03 20 04 00 00 00 00", "2B 03 20 05 01 00 00 00",
              "2B 03 20 06 00 00 00 00"});
  drive.drive->setPulseWidth(0.3, drive.now);
  drive.run(ms(500));
  EXPECT_EQ(drive.speed(), 0.0);
  drive.input(2, false);
  EXPECT_GT(drive.speed(), 0.1);
  EXPECT_EQ(drive.ask("40 0B 20 07 00 00 00 00"), "4B 0B 20 07 1E 00 00 00") << "30 %";
}

// DI0 as the positive limit switch, active low [1890-1897]
TEST(NimotionPrintedTerminals, MakeALimitSwitchOfDi0) {
  sim::AxisMechanics mechanics;
  mechanics.positive_limit_switch = 1.0;
  PrintedDrive drive(kPrintedStepper, mechanics);
  drive.take({"2B 03 20 01 0E 00 00 00", "2B 03 20 02 00 00 00 00", "2F 60 60 00 03 00 00 00",
              "23 FF 60 00 A0 0F 00 00", "2B 40 60 00 06 00 00 00", "2B 40 60 00 07 00 00 00",
              "2B 40 60 00 0F 00 00 00"});
  EXPECT_EQ(drive.read(0x200B, 3) & 1U, 1U) << "high: not active";
  drive.run(ms(3000));
  EXPECT_EQ(drive.read(0x200B, 3) & 1U, 0U);
  EXPECT_EQ(drive.speed(), 0.0);
  EXPECT_NEAR(drive.turns(), 1.0, 0.1);
  ASSERT_FALSE(drive.emergencies().empty());
  EXPECT_EQ(drive.emergencies()[0].first, 0xFF0F);
}

// DX0 by its bit of 2004h:01; DX1 while the motor has power [1947-1963].
TEST(NimotionPrintedOutputs, AreHighAsTheExamplesSay) {
  PrintedDrive drive(kPrintedStepper);
  const auto high = [&] { return drive.drive->truth(drive.now).outputs & 3U; };
  drive.take({"2B 21 20 01 01 00 00 00", "2B 04 20 02 00 00 00 00", "2B 04 20 03 01 00 00 00"});
  EXPECT_EQ(high(), 0U);
  drive.take({"2B 04 20 01 01 00 00 00"});
  EXPECT_EQ(high(), 1U);
  drive.take({"2B 21 20 02 01 00 00 00", "2B 04 20 04 03 00 00 00", "2B 04 20 05 01 00 00 00"});
  EXPECT_EQ(high(), 1U);
  drive.enable();
  EXPECT_EQ(high(), 3U);
  drive.control(0x0000);
  EXPECT_EQ(high(), 1U);
  PrintedAxis scene(printedJoint("pp", {2.0, 10.0},
                                 ", write: [{object: dx1_is_output, raw: 1}, {object: "
                                 "do1_function, raw: 3}, {object: do1_logic, raw: 1}]" +
                                     printedRows("[0x2021, 2, DX1InOutSelec, uint16, rw, r, 0], "
                                                 "[0x2004, 5, DO1LogicSelec, uint16, rw, r, 0]")));
  EXPECT_TRUE(inOrder(scene.writes(), {"2B 21 20 02 01 00 00 00", "2B 04 20 04 03 00 00 00",
                                       "2B 04 20 05 01 00 00 00"}));
  EXPECT_TRUE(scene.call(bus::SetOutputsCommand{"joint", {"do0"}, {true}}).success);
  EXPECT_THAT(scene.writes(), Contains("2B 04 20 01 01 00 00 00"));
  EXPECT_EQ(scene.truth("joint").outputs & 3U, 1U);
  scene.enable();
  EXPECT_EQ(scene.truth("joint").outputs & 3U, 3U);
}

// What the driver writes of those examples, by the names of its profile.
TEST(NimotionPrintedTerminals, AreWrittenByTheirNames) {
  TracedScene scene(busJoint(nimotionIn("pp")));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.run(1s);
  struct Row {
    const char *object, *number, *bytes;
  };
  for (const Row& row : {Row{"step_amount", "50", "23 05 20 02 32 00 00 00"},
                         Row{"di0_function", "1", "2B 03 20 01 01 00 00 00"},
                         Row{"di0_logic", "0", "2B 03 20 02 00 00 00 00"},
                         Row{"di1_function", "20", "2B 03 20 03 14 00 00 00"},
                         Row{"di1_logic", "2", "2B 03 20 04 02 00 00 00"},
                         Row{"maker_velocity_source", "0", "2B 06 20 01 00 00 00 00"},
                         Row{"maker_acceleration_time", "200", "2B 06 20 03 C8 00 00 00"},
                         Row{"maker_deceleration_time", "200", "2B 06 20 04 C8 00 00 00"},
                         Row{"maker_velocity", "120", "2B 06 20 02 78 00 00 00"},
                         Row{"maker_velocity_source", "3", "2B 06 20 01 03 00 00 00"},
                         Row{"maker_acceleration_time", "100", "2B 06 20 03 64 00 00 00"},
                         Row{"maker_deceleration_time", "100", "2B 06 20 04 64 00 00 00"},
                         Row{"di0_function", "44", "2B 03 20 01 2C 00 00 00"},
                         Row{"di1_function", "45", "2B 03 20 03 2D 00 00 00"},
                         Row{"di1_logic", "0", "2B 03 20 04 00 00 00 00"},
                         Row{"di2_function", "1", "2B 03 20 05 01 00 00 00"},
                         Row{"di2_logic", "0", "2B 03 20 06 00 00 00 00"},
                         Row{"di0_function", "14", "2B 03 20 01 0E 00 00 00"},
                         Row{"dx0_is_output", "1", "2B 21 20 01 01 00 00 00"},
                         Row{"do0_function", "0", "2B 04 20 02 00 00 00 00"},
                         Row{"do0_logic", "1", "2B 04 20 03 01 00 00 00"},
                         Row{"dx1_is_output", "1", "2B 21 20 02 01 00 00 00"},
                         Row{"do1_function", "3", "2B 04 20 04 03 00 00 00"},
                         Row{"do1_logic", "1", "2B 04 20 05 01 00 00 00"},
                         Row{"control_mode_select", "1", "2B 02 20 01 01 00 00 00"},
                         Row{"control_mode_select", "2", "2B 02 20 01 02 00 00 00"}}) {
    scene.clear();
    const bus::Answer written =
        scene.call(bus::WriteObjectCommand{"joint", row.object, row.number});
    EXPECT_TRUE(written.success) << written.message;
    EXPECT_THAT(scene.writes(), Contains(row.bytes)) << row.object;
    scene.run(500ms);
  }
}

}  // namespace
}  // namespace cia402
