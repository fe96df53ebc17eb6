// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a NiMotion is set to: scales, windows, limits, currents, gains, alarms, and its memory.
#include "system/families_motion.h"
#include "system/refused_enabling.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kNimotionTurn = 6.283185307179586;

std::string withNimotionRows(const std::string& rows) {
  return ", simulation: {with: {dictionary: [" + rows + "]}}";
}

/// 608Fh:01, :02, 6091h:01, :02 as the drive is delivered, and 2002h:02.
struct Scaled {
  const char* name;
  const char *increments, *revolutions, *motor, *shaft, *closed;
  double counts;  ///< of a turn of the motor: R / G [574-656]
};

std::string scaledNimotion(const Scaled& scaled, const char* mode, double counts) {
  std::string yaml = familyJoint(
      nimotionIn(mode),
      withNimotionRows("[0x608F, 1, encoder_increments, uint32, rw, -, " +
                       std::string(scaled.increments) +
                       "], [0x608F, 2, revolutions, uint32, rw, -, " + scaled.revolutions +
                       "], [0x6091, 1, motor, uint32, rw, -, " + scaled.motor +
                       "], [0x6091, 2, shaft, uint32, rw, -, " + scaled.shaft +
                       "], [0x2002, 2, CloseLoopEn, uint16, rw, -, " + scaled.closed + ", 0, 1]"));
  return replaced(yaml, "counts_per_turn: 4000", "counts_per_turn: " + std::to_string(counts));
}

class NimotionScale : public testing::TestWithParam<Scaled> {};

TEST_P(NimotionScale, TurnsTheMotorByWhatIsCommanded) {
  const double counts = GetParam().counts;
  for (const char* mode : {"pp", "csp", "pv", "vl"}) {
    FamilyScene scene(scaledNimotion(GetParam(), mode, counts));
    if (scene.kind() == ControlKind::position) {
      ASSERT_EQ(scene.setpoint("joint", 0.7), "");
      scene.run(3s);
      EXPECT_NEAR(scene.position("joint"), 0.7, 1.1 * kNimotionTurn / 50.0 / counts + 1e-6) << mode;
      EXPECT_NEAR(scene.state("joint").position, 0.7, 1.1 * kNimotionTurn / 50.0 / counts + 1e-6)
          << mode;
    } else {
      scene.stream("joint", 0.5, 800ms);
      EXPECT_NEAR(scene.velocity("joint"), 0.5, 2.1e-3) << mode << ": 1/min is 2.1e-3 rad/s";
      EXPECT_NEAR(scene.state("joint").velocity, 0.5, 2.1e-3) << mode << ": 606Ch counts in 1/min";
    }
  }
}

TEST_P(NimotionScale, ThatTheAxisIsNotToldIsRefusedWithTheNumbers) {
  expectRefusedEnabling(scaledNimotion(GetParam(), "pp", 1.1 * GetParam().counts),
                        "the drive counts ", "set the drive by `write` of the axis");
}

INSTANTIATE_TEST_SUITE_P(
    Nimotion, NimotionScale,
    testing::Values(Scaled{"ClosedLoop", "4000", "1", "1", "1", "1", 4000.0},
                    Scaled{"OpenLoop", "1600", "1", "1", "1", "0", 1600.0},
                    Scaled{"Fine", "40000", "1", "1", "1", "1", 40000.0},
                    Scaled{"OfTwoTurns", "10000", "2", "1", "1", "1", 5000.0},
                    Scaled{"BehindAGearOfThree", "4000", "1", "3", "1", "1", 4000.0 / 3.0},
                    Scaled{"BehindAGearOfTwoFifths", "4000", "1", "2", "5", "1", 10000.0}),
    [](const auto& tested) { return std::string(tested.param.name); });

// 2002h:02 [2542]: without an encoder a stall goes unnoticed.
TEST(NimotionLoop, ThatIsOpenIsToldOnceAndServed) {
  const Scaled open{"", "1600", "1", "1", "1", "0", 1600.0};
  FamilyScene scene(scaledNimotion(open, "pp", 1600.0));
  const std::string told = scene.told();
  EXPECT_THAT(told, HasSubstr("closed_loop (2002:02) is 0 instead of 1, it runs open loop"));
  scene.mustSucceed(ProcedureKind::disable);
  scene.mustSucceed(ProcedureKind::enable);
  EXPECT_EQ(scene.told(), told) << "not again";
  ASSERT_EQ(scene.setpoint("joint", 0.5), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 0.5, 2e-4);
}

TEST(NimotionLoop, IsChosenByTheFileOrByAServiceWhileItIsDisabled) {
  FamilyScene scene(familyJoint(nimotionIn("pp"), ", write: [{object: closed_loop, raw: 0}]"));
  EXPECT_EQ(scene.number(0x2002, 2), 0U);
  const bus::WriteObjectCommand closed{"joint", "closed_loop", "1"};
  const auto refused = scene.call(closed);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("disable it first"));
  EXPECT_EQ(scene.number(0x2002, 2), 0U);
  scene.mustSucceed(ProcedureKind::disable);
  const auto taken = scene.call(closed);
  EXPECT_TRUE(taken.success) << taken.message;
  EXPECT_EQ(scene.number(0x2002, 2), 1U);
}

// Anything but 2, and the drive is gone from this bus [2596-2597].
TEST(NimotionBusChoice, IsNotWrittenByAnyName) {
  FamilyScene scene(familyJoint(nimotionIn("csp")));
  scene.mustSucceed(ProcedureKind::disable);
  for (const char* name : {"communication_select", "200C:01", "200Ch:1 u16"}) {
    for (const char* value : {"1", "3", "0"}) {
      const auto refused = scene.call(bus::WriteObjectCommand{"joint", name, value});
      EXPECT_FALSE(refused.success) << name;
      EXPECT_THAT(refused.message, AllOf(HasSubstr("200C:01"), HasSubstr("takes 2 "))) << name;
      EXPECT_EQ(scene.number(0x200C, 1), 2U);
    }
  }
  Problems problems;
  config::loadRobot(YAML::Load(familyJoint(nimotionIn("csp"),
                                           ", write: [{object: communication_select, raw: 1}]")),
                    config::profilesIn({test::configFolder() + "/drives"}), problems);
  if (problems.empty()) {
    Scene other(loadText(
        familyJoint(nimotionIn("csp"), ", write: [{object: communication_select, raw: 1}]")));
    (void)other.boot(5s);
    EXPECT_EQ(other.drive("joint").dictionary().find({0x200C, 1})->number, 2U);
  }
}

// 6067h, 6068h: 0.1 rad are 3183 counts; bit 10 rises so long after the motor came that near.
TEST(NimotionWindow, OfPositionsIsThatOfTheFile) {
  FamilyScene scene(familyJoint(nimotionIn("pp"),
                                ", write: [{object: position_window, value: 0.1}, "
                                "{object: position_window_time, value: 0.1}]"));
  EXPECT_EQ(scene.number(0x6067), 3183U);
  EXPECT_EQ(scene.number(0x6068), 100U);
  ASSERT_EQ(scene.setpoint("joint", 1.0), "");
  scene.run(100ms);
  ASSERT_FALSE(scene.state("joint").target_reached);
  ASSERT_TRUE(scene.runUntil([&] { return scene.position("joint") > 0.9; }, 4s));
  const Time inside = scene.now();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("joint").target_reached; }, 4s));
  EXPECT_NEAR(toSeconds(scene.now() - inside), 0.1, 0.012);
  EXPECT_LT(scene.position("joint"), 0.999) << "still on its way";
}

// 606Dh in 1/min, 606Fh in counts/s [2702-2709]: 0.1 rad/s are 47.7/min, or 3183 counts/s.
TEST(NimotionWindow, OfVelocitiesAndOfStandstillAreThoseOfTheFile) {
  FamilyScene scene(familyJoint(nimotionIn("pv"),
                                ", write: [{object: velocity_window, value: 0.1}, "
                                "{object: velocity_window_time, value: 0.05}, "
                                "{object: velocity_threshold, value: 0.1}, "
                                "{object: velocity_threshold_time, value: 0.05}, "
                                "{object: profile_acceleration, value: 0.5}]"));
  EXPECT_EQ(scene.number(0x606D), 48U);
  EXPECT_EQ(scene.number(0x606E), 50U);
  EXPECT_EQ(scene.number(0x606F), 3183U);
  EXPECT_EQ(scene.number(0x6070), 50U);
  const auto bit = [&](unsigned number) {
    return ((scene.truth("joint").statusword >> number) & 1u) != 0;
  };
  scene.run(200ms);
  ASSERT_TRUE(bit(12));
  const auto since = [&](double speed, unsigned number, bool faster) {
    EXPECT_TRUE(scene.runUntil(
        [&] {
          (void)scene.setpoint("joint", faster ? 0.6 : 0.0);
          return faster ? scene.velocity("joint") > speed : scene.velocity("joint") < speed;
        },
        3s));
    EXPECT_FALSE(bit(number));
    const Time there = scene.now();
    EXPECT_TRUE(scene.runUntil(
        [&] {
          (void)scene.setpoint("joint", faster ? 0.6 : 0.0);
          return bit(number);
        },
        1s));
    return toSeconds(scene.now() - there);
  };
  // The motor follows by 0.5 rad/s^2: it is 0.1 below the target of 0.6 after a second.
  EXPECT_NEAR(since(0.5, 10, true), 0.05, 0.012);
  EXPECT_LT(scene.velocity("joint"), 0.56);
  EXPECT_NEAR(since(0.1, 12, false), 0.05, 0.012);
}

// mA, 0.1 A, V [2526-2537]
TEST(NimotionPower, IsSetByTheFileInItsUnitsAndTakenAtRestOnly) {
  FamilyScene scene(familyJoint(
      nimotionIn("csp"),
      ", write: [{object: run_current, value: 1.2}, {object: idle_current, value: 0.3}, "
      "{object: over_current_level, value: 5.5}, {object: over_voltage_level, value: 28}, "
      "{object: under_voltage_level, value: 18}, {object: microstep, raw: 4}]"));
  const std::pair<unsigned, std::uint64_t> written[] = {{3, 1200}, {6, 300}, {7, 55},
                                                        {1, 28},   {2, 18},  {8, 4}};
  for (const auto& [sub, number] : written) {
    EXPECT_EQ(scene.number(0x2001, static_cast<std::uint8_t>(sub)), number) << sub;
  }
  for (const char* name : {"run_current", "idle_current", "over_current_level",
                           "over_voltage_level", "under_voltage_level", "microstep"}) {
    const auto refused = scene.call(bus::WriteObjectCommand{"joint", name, "20"});
    EXPECT_FALSE(refused.success) << name;
    EXPECT_THAT(refused.message, HasSubstr("disable it first")) << name;
  }
  for (const auto& [sub, number] : written) {
    EXPECT_EQ(scene.number(0x2001, static_cast<std::uint8_t>(sub)), number) << sub;
  }
  scene.mustSucceed(ProcedureKind::disable);
  scene.run(200ms);
  const auto taken = scene.call(bus::WriteObjectCommand{"joint", "run_current", "700"});
  EXPECT_TRUE(taken.success) << taken.message;
  EXPECT_THAT(taken.message, HasSubstr("0.7"));
  EXPECT_EQ(scene.number(0x2001, 3), 700U);
}

// [2572-2585]: all of them count at once, so they are tuned while it runs.
TEST(NimotionGains, AreTunedWhileItRunsWithinTheirRanges) {
  struct Row {
    const char* name;
    std::uint8_t sub;
    const char *value, *beyond;
  };
  FamilyScene scene(familyJoint(nimotionIn("pv")));
  scene.stream("joint", 0.4, 500ms);
  for (const Row& row :
       {Row{"position_gain", 1, "150", "65536"}, Row{"current_gain", 2, "400", "65536"},
        Row{"velocity_control_filter", 3, "12", "65536"},
        Row{"velocity_display_filter", 4, "30", "65536"}, Row{"stall_error", 5, "60", "101"},
        Row{"stall_speed", 6, "9", "101"}, Row{"stall_time", 7, "1500", "65536"},
        Row{"velocity_feed_forward", 9, "20", "65536"},
        Row{"velocity_feed_forward_filter", 10, "90", "1001"},
        Row{"velocity_command_filter", 11, "450", "1001"},
        Row{"acceleration_clamp", 12, "180", "1001"},
        Row{"current_feed_forward", 13, "3900", "65536"},
        Row{"current_feed_forward_filter", 14, "950", "1001"}}) {
    const auto taken = scene.call(bus::WriteObjectCommand{"joint", row.name, row.value});
    EXPECT_TRUE(taken.success) << taken.message;
    EXPECT_EQ(scene.number(0x2008, row.sub), std::stoul(row.value)) << row.name;
    const auto refused = scene.call(bus::WriteObjectCommand{"joint", row.name, row.beyond});
    EXPECT_FALSE(refused.success) << row.name;
    EXPECT_EQ(scene.number(0x2008, row.sub), std::stoul(row.value)) << row.name;
    EXPECT_EQ(scene.setpoint("joint", 0.4), "") << "it runs on";
  }
  scene.stream("joint", 0.4, 200ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.4, 3e-3) << scene.told();
}

// 607Fh, 6080h, 60C5h, 60C6h, 2008h:0C: what the drive holds is compared with what was written.
TEST(NimotionLimits, AreReadBackAndToldWhereTheDriveHoldsOthers) {
  struct Row {
    const char *name, *row;
  };
  for (const Row& row : {Row{"max_profile_velocity (607F:00)", "0x607F, 0"},
                         Row{"max_motor_speed (6080:00)", "0x6080, 0"},
                         Row{"max_acceleration (60C5:00)", "0x60C5, 0"},
                         Row{"max_deceleration (60C6:00)", "0x60C6, 0"},
                         Row{"acceleration_clamp (2008:0C)", "0x2008, 12"}}) {
    Scene scene(loadText(
        familyJoint(nimotionIn("pp"), ", write: [{object: acceleration_clamp, raw: 150}]")));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    EXPECT_THAT(scene.told(), Not(HasSubstr("that was written at the boot")));
    const std::string where = row.row;
    const auto index = static_cast<std::uint16_t>(std::stoul(where.substr(0, 6), nullptr, 16));
    const auto sub = static_cast<std::uint8_t>(std::stoul(where.substr(8)));
    sim::Entry* entry = scene.drive("joint").dictionary().find({index, sub});
    const std::uint64_t written = entry->number;
    entry->number = written / 2;
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    EXPECT_TRUE(enabled.success) << enabled.message;
    EXPECT_THAT(scene.told(), HasSubstr(std::string(row.name) + " is " +
                                        std::to_string(written / 2) + " instead of the " +
                                        std::to_string(written) + " that was written at the boot"));
  }
  FamilyScene well(familyJoint(nimotionIn("pp")));
  EXPECT_THAT(well.told(), Not(HasSubstr("that was written at the boot")));
}

// "The larger" of 607Bh and 607Dh counts [2230]: by its magnitude, or as a number. One of them
// alone limits nothing, so both are written (FamilyLimitNumbers).
TEST(NimotionLimits, OfPositionsHoldWhereBothObjectsHaveThem) {
  for (const char* use : {"farther", "greater"}) {
    for (const bool both : {false, true}) {
      FamilyScene scene(familyJoint(
          nimotionIn("pv"),
          ", simulation: {with: {state_machine: {position_range: " + std::string(use) + "}}}"));
      const auto limit = static_cast<std::uint64_t>(1.0 / oneCount(nimotionIn("pv")));
      scene.drive("joint").dictionary().find({0x607D, 2})->number = limit;
      if (both) scene.drive("joint").dictionary().find({0x607B, 2})->number = limit;
      const Time end = scene.now() + 5s;
      while (scene.now() < end) {
        (void)scene.setpoint("joint", 0.8);
        scene.run(20ms);
      }
      EXPECT_NEAR(scene.position("joint"), both ? 1.0 : 2.5, 0.02) << use << scene.told();
    }
  }
}

// Reaction, self-reset, code [2112-2175].
TEST(NimotionAlarmWords, AreReadInWords) {
  FamilyScene scene(familyJoint(nimotionIn("csp")));
  for (const auto& [name, words] :
       {std::pair("alarm_stall",
                  "reaction 3 (warning, the motor is stopped quickly and held), resets itself 1 "
                  "(yes), code 0x7121"),
        std::pair("alarm_over_voltage",
                  "reaction 0 (fault, stopped as 605Eh says, else it coasts), resets itself 1 "
                  "(yes), code 0x3110"),
        std::pair("alarm_over_current",
                  "reaction 0 (fault, stopped as 605Eh says, else it coasts), resets itself 0 "
                  "(no), code 0x2300"),
        std::pair("alarm_position_limit",
                  "reaction 4 (warning, the motor goes on), resets itself 1 (yes), code 0xFF10")}) {
    const auto read = scene.call(bus::ReadObjectCommand{"joint", name});
    EXPECT_TRUE(read.success) << read.message;
    EXPECT_THAT(read.message, HasSubstr(words)) << name;
  }
}

TEST(NimotionAlarmWords, ThatCannotBeAdjustedAreNotWritten) {
  FamilyScene scene(familyJoint(nimotionIn("csp")));
  for (const char* name :
       {"alarm_over_current", "alarm_over_temperature", "alarm_eeprom_self_check",
        "alarm_thermal_shutdown", "alarm_driver_wrong_command", "alarm_driver_not_executable",
        "alarm_driver_spi", "alarm_driver_self_check"}) {
    const auto refused = scene.call(bus::WriteObjectCommand{"joint", name, "0x04007121"});
    EXPECT_FALSE(refused.success) << name;
    EXPECT_THAT(refused.message, HasSubstr("in the drive's own numbers")) << name;
  }
}

// A stall as a warning that holds, as one that goes on, as a fault, and as nothing.
TEST(NimotionAlarmWords, ThatAreWrittenDecideWhatTheAlarmDoes) {
  struct Row {
    const char* word;
    bool powered, halted, history;
  };
  for (const Row& row :
       {Row{"0x03017121", true, true, true}, Row{"0x04017121", true, false, true},
        Row{"0x00007121", false, false, true}, Row{"0x05017121", true, false, true},
        Row{"0x06017121", true, false, false}}) {
    FamilyScene scene(familyJoint(nimotionIn("pv")));
    const auto written = scene.call(bus::WriteObjectCommand{"joint", "alarm_stall", row.word});
    ASSERT_TRUE(written.success) << written.message;
    scene.stream("joint", 0.4, 400ms);
    scene.inject("joint", "stall");
    const Time end = scene.now() + 400ms;
    while (scene.now() < end) {
      (void)scene.setpoint("joint", 0.4);
      scene.run(20ms);
    }
    EXPECT_EQ(scene.truth("joint").power_stage_on, row.powered) << row.word << scene.told();
    const bool goes_on = row.powered && !row.halted && row.word[3] != '4';
    EXPECT_NEAR(scene.velocity("joint"), goes_on ? 0.4 : 0.0, goes_on ? 3e-3 : 0.41) << row.word;
    const auto history = scene.call(bus::ErrorHistoryCommand{"joint"});
    EXPECT_EQ(history.history.entries.empty(), !row.history) << row.word << history.message;
  }
}

// What is restored counts after the power was off [1989-1995]; NMT resets do nothing there.
TEST(NimotionMemory, IsRestoredWithTheHintToSwitchThePowerOffAndOn) {
  FamilyScene scene(
      familyJoint(nimotionIn("csp"), ", parameters: {save: [1, 4], restore: [1, 4]}"));
  const auto refused = scene.procedure(ProcedureKind::restore_parameters, "joint");
  EXPECT_FALSE(refused.success);
  scene.mustSucceed(ProcedureKind::disable);
  scene.mustSucceed(ProcedureKind::save_parameters);
  const auto restored = scene.procedure(ProcedureKind::restore_parameters, "joint");
  EXPECT_TRUE(restored.success) << restored.message;
  EXPECT_THAT(restored.message,
              AllOf(HasSubstr("switch it off and on"), HasSubstr("for the values to count")));
}

}  // namespace
}  // namespace cia402
