// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What an iD286-CNFA must be set to, that it holds what was written, and what it takes.
#include <cmath>

#include "drive/profile/named_write.h"
#include "system/id286_scene.h"
#include "system/refused_enabling.h"
#include "system/stubborn_object.h"
#include "system/traced_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string withoutCurrent() {
  return replaced(familyJoint(kId286InPp), ", keeps: [motor_current]", "");
}

/// Every setting of its motor [L1356-1431], with its number.
constexpr char kAllSettings[] =
    ", write: [{object: motor_current, value: 2.8}, {object: idle_current, raw: 60},"
    " {object: idle_current_delay, value: 0.3}, {object: motor_mode, raw: 1},"
    " {object: encoder_resolution, raw: 20000}, {object: motor_direction, raw: 3},"
    " {object: following_error_limit, raw: 2000}, {object: in_position_range, raw: 7}]";
struct Id286Setting {
  std::uint16_t index;
  std::uint64_t number;
};
constexpr Id286Setting kAllNumbers[] = {{0x20F1, 2800},  {0x20D5, 60}, {0x20F5, 300},  {0x20D9, 1},
                                        {0x20F6, 20000}, {0x20C9, 3},  {0x2102, 2000}, {0x20F7, 7}};

TEST(Id286Current, ThatNobodyGaveIsRefusedBeforeItIsEnabled) {
  expectRefusedEnabling(withoutCurrent(), "motor_current (20F1:00) is 1000, which nobody has given",
                        "give it by `write` of the axis, or name it in `keeps`");
}

TEST(Id286Current, IsTakenWhereTheAxisGivesItOrKeepsIt) {
  for (const std::string& yaml : {familyJoint(kId286InPp),
                                  replaced(familyJoint(kId286InPp), ", keeps: [motor_current]",
                                           ", write: [{object: motor_current, value: 2.8}]"),
                                  replaced(familyJoint(kId286InPp), ", keeps: [motor_current]",
                                           ", write: [{object: \"20F1:00\", raw: 2800}]")}) {
    Scene scene(loadText(yaml));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    EXPECT_TRUE(enabled.success) << enabled.message;
    const bool kept = yaml.find("write") == std::string::npos;
    EXPECT_EQ(scene.drive("joint").dictionary().find({0x20F1, 0})->number, kept ? 1000U : 2800U);
  }
}

TEST(Id286Settings, StandInTheDriveBeforeTheFirstCommandOfTheStateMachine) {
  Id286Trace scene(familyJoint(kId286InPp, kAllSettings));
  bool looked = false;
  scene.watch([&] {
    if (looked || scene.number(0x6040) != 0x06) return;
    looked = true;
    for (const Id286Setting& setting : kAllNumbers) {
      EXPECT_EQ(scene.number(setting.index), setting.number) << std::hex << setting.index;
    }
  });
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  EXPECT_FALSE(looked);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_TRUE(looked);
}

// Nothing is saved: after a restart all has its factory's number until the boot writes it anew.
TEST(Id286Settings, AndRampsAreWrittenAnewAtEachStart) {
  Id286Trace scene(familyJoint(kId286InPp, kAllSettings));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto expectWritten = [&] {
    for (const Id286Setting& setting : kAllNumbers) {
      EXPECT_EQ(scene.number(setting.index), setting.number) << std::hex << setting.index;
    }
    // 0.8 rad/s, 4 rad/s^2 and 8 rad/s^2 in counts; 1.05 times 0.8 rad/s in rpm of the motor.
    EXPECT_NEAR(static_cast<double>(scene.number(0x6081)), 63662.0, 1.0);
    EXPECT_NEAR(static_cast<double>(scene.number(0x6083)), 318310.0, 1.0);
    EXPECT_NEAR(static_cast<double>(scene.number(0x6084)), 318310.0, 1.0);
    EXPECT_NEAR(static_cast<double>(scene.number(0x6085)), 636620.0, 1.0);
    EXPECT_NEAR(static_cast<double>(scene.number(0x6080)), 401.0, 1.0);
  };
  expectWritten();
  scene.inject("joint", "power_cycle");
  scene.run(600ms);
  EXPECT_EQ(scene.number(0x6085), 40000000U) << "the factory's";
  EXPECT_EQ(scene.number(0x20F1), 1000U);
  scene.run(1s);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 20s)) << scene.told();
  expectWritten();
}

/// What an SDO frame names: "81 60 00".
std::string addressed(const std::string& line) { return line.substr(7, 8); }

// Each write of a parameter by SDO is followed by a read of the same object.
TEST(Id286ReadBack, FollowsEveryParameterThatIsWritten) {
  TracedScene scene(familyJoint(
      kId286InPp, std::string(kAllSettings) +
                      ", homing: {method: 17, search_velocity: 0.4, zero_velocity: 0.05, "
                      "acceleration: 2.0, offset: 0.1}, simulation: {lower_limit_switch: -0.4}"));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home).success) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  std::size_t parameters = 0;
  std::string missing;
  for (std::size_t i = 0; i < scene.lines.size(); ++i) {
    const std::string& line = scene.lines[i];
    const bool written = line.compare(0, 5, "601 2") == 0 && line.size() > 14;
    if (!written) continue;
    const std::string object = addressed(line), index = object.substr(3, 2) + object.substr(0, 2);
    // 301's; commands, the mode (6061h tells it), and a set-point that an RPDO carries as well.
    if (index < "2000" || index == "6040" || index == "6060" || index == "607A") continue;
    ++parameters;
    std::size_t next = i + 1;
    while (next < scene.lines.size() && scene.lines[next].compare(0, 4, "601 ") != 0) ++next;
    const bool read = next < scene.lines.size() && scene.lines[next].compare(0, 6, "601 40") == 0 &&
                      addressed(scene.lines[next]) == object;
    if (!read) missing += line + "\n";
  }
  EXPECT_GT(parameters, 20U);
  EXPECT_EQ(missing, "");
}

TEST(Id286ReadBack, OfTheBootEndsItWithObjectAndNumbers) {
  for (const auto& [index, told] :
       {std::pair<std::uint16_t, const char*>(0x20F1,
                                              "the drive took 0x0AF0 for 20F1:00 motor_current"),
        std::pair<std::uint16_t, const char*>(
            0x6085, "the drive took 0x0009B6CC for 6085:00 quick_stop_deceleration")}) {
    Scene scene(loadText(familyJoint(kId286InPp, kAllSettings)));
    clamp(scene, index, 0, 17);
    EXPECT_FALSE(scene.boot(10s));
    EXPECT_THAT(scene.told(), AllOf(HasSubstr(told), HasSubstr(", but holds 0x00")));
    EXPECT_FALSE(scene.procedure(ProcedureKind::enable).success);
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
  }
}

TEST(Id286ReadBack, BeforeEnablingAndHomingRefusesThemInWords) {
  Scene scene(loadText(
      familyJoint(kId286InPp, ", homing: {method: 35, search_velocity: 0.4, acceleration: 2.0}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  clamp(scene, 0x6099, 1, 17);
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message,
              AllOf(HasSubstr("joint (node 1): the drive took "),
                    HasSubstr("homing_search_velocity (6099:01)"), HasSubstr("but holds 0x11;")));
  clamp(scene, 0x6071, 0, 100);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message,
              AllOf(HasSubstr("target_torque (6071:00)"), HasSubstr("but holds 0x64;")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

TEST(Id286ReadBack, OfWhatSomebodyWritesIsToldInTheAnswer) {
  Scene scene(loadText(familyJoint(kId286InPp)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto write = [&] {
    return call(scene, bus::WriteObjectCommand{"joint", "idle_current", "60"});
  };
  bus::Answer written = write();
  EXPECT_TRUE(written.success) << written.message;
  clamp(scene, 0x20D5, 0, 17);
  written = write();
  EXPECT_FALSE(written.success);
  EXPECT_THAT(written.message, AllOf(HasSubstr("joint (node 1): wrote 60 to 20D5:00 idle_current"),
                                     HasSubstr("but it is 17"), HasSubstr("read back")));
}

// What shifts its coordinates, or is calibration: 20C9h, 20D9h, 20F2h, 20F6h.
TEST(Id286ReadBack, OfCoordinatesAndCalibrationIsToldInTheAnswer) {
  struct Row {
    std::uint16_t index;
    const char *object, *value;
  };
  for (const Row& row :
       {Row{0x20C9, "motor_direction", "3"}, Row{0x20D9, "motor_mode", "1"},
        Row{0x20F2, "resolution", "20000"}, Row{0x20F6, "encoder_resolution", "20000"}}) {
    TracedScene scene(familyJoint(kId286InPp));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    scene.run(300ms);
    scene.clear();
    const auto write = [&] {
      return call(scene, bus::WriteObjectCommand{"joint", row.object, row.value});
    };
    bus::Answer written = write();
    EXPECT_TRUE(written.success) << written.message;
    EXPECT_THAT(written.message, HasSubstr("is not homed any more"));
    const auto low = static_cast<std::uint8_t>(row.index & 0xFFU);
    const std::string address = wireText(can::Frame(0x601, {0x40, low, 0x20, 0x00}));
    EXPECT_EQ(scene.count(address), 1U) << address;
    clamp(scene, row.index, 0, 17);
    scene.run(300ms);
    written = write();
    EXPECT_FALSE(written.success);
    EXPECT_THAT(written.message,
                AllOf(HasSubstr("joint (node 1): wrote " + std::string(row.value) + " to "),
                      HasSubstr(row.object), HasSubstr("but it is 17 ("),
                      HasSubstr("when it is read back"), HasSubstr("is not homed any more")));
  }
}

TEST(Id286ReadBack, OfPositionLimitsRefusesEnabling) {
  Scene scene(loadText(familyJoint(kId286InPp)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  clamp(scene, 0x607D, 2, 17);
  scene.drive("joint").dictionary().find({0x607D, 2})->number = 17;
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, AllOf(HasSubstr("software_limit_max (607D:02)"),
                                     HasSubstr("but holds 17 when it is read back")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

/// Axes with one PDO each way. @param more of `bus`
std::string pairsOfPdos(unsigned axes, const std::string& bitrate, const std::string& period) {
  std::string yaml = "bus: {interface: sim, bitrate: " + bitrate + ", sync_period: " + period +
                     ", heartbeat: 0.5}\naxes:\n";
  for (unsigned i = 1; i <= axes; ++i) {
    yaml += "  j" + std::to_string(i) + ": {node_id: " + std::to_string(i) +
            ", drive: id286_cnfa, counts_per_turn: 10000, mode: pv, modes: [pv],"
            " limits: {velocity: 20.0, acceleration: 50.0},"
            " pdos: {rpdo1: [controlword, target_velocity],"
            " tpdo1: [statusword, position_actual, mode_display]}}\n";
  }
  return yaml;
}

std::string warningsOf(const std::string& yaml) {
  Problems problems;
  const config::RobotConfig robot = config::loadRobot(
      YAML::Load(yaml), config::profilesIn({test::configFolder() + "/drives"}), problems);
  EXPECT_TRUE(problems.empty()) << problems.text();
  std::string all;
  for (const std::string& warning : robot.warnings) all += warning + "\n";
  return all;
}

// 24 PDOs: 24 / 9 / 40 % + 2 ms = 8.67 ms [L1205-1215]; at half the rate twice the first part.
TEST(Id286Period, ThatIsShorterThanTheMakersRuleIsWarnedOf) {
  EXPECT_THAT(
      warningsOf(pairsOfPdos(12, "1000000", "0.008")),
      HasSubstr("the maker of id286_cnfa advises 0.0087 s or more for 24 PDOs, not 0.008 s"));
  EXPECT_THAT(warningsOf(pairsOfPdos(12, "1000000", "0.009")), Not(HasSubstr("advises")));
  EXPECT_THAT(warningsOf(pairsOfPdos(12, "500000", "0.015")),
              HasSubstr("advises 0.0154 s or more for 24 PDOs"));
  EXPECT_THAT(warningsOf(pairsOfPdos(12, "500000", "0.016")), Not(HasSubstr("advises")));
  EXPECT_THAT(warningsOf(pairsOfPdos(1, "1000000", "0.0025")),
              HasSubstr("advises 0.0026 s or more for 2 PDOs"));
}

TEST(Id286Ranges, AreThoseOfTheSimulatedDriveAndRefusedByBothInWords) {
  Scene scene(loadText(familyJoint(kId286InPp)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  sim::ObjectDictionary& dictionary = scene.drive("joint").dictionary();
  unsigned compared = 0;
  for (const drive::ObjectSpec& object : scene.loaded().robot.axes[0].profile->objects) {
    if (!object.range) continue;
    ++compared;
    const sim::Entry& entry = *dictionary.find(object.id);
    ASSERT_TRUE(entry.low && entry.high) << object.name;
    if (object.type == entry.type) {  // 605Ah, 6080h and 6083h are printed with another sign
      EXPECT_EQ(object.range->low, *entry.low) << object.name;
      EXPECT_EQ(object.range->high, *entry.high) << object.name;
    }
    const std::uint64_t held = entry.number;
    for (const double beyond : {object.range->low - 1.0, object.range->high + 1.0}) {
      bus::WriteObjectCommand write;
      write.axis = "joint";
      write.object = object.name;
      write.value = std::to_string(static_cast<std::int64_t>(beyond));
      const bus::Answer refused = call(scene, write);
      EXPECT_FALSE(refused.success) << object.name << " = " << write.value;
      EXPECT_THAT(refused.message, HasSubstr(object.name));
      EXPECT_EQ(entry.number, held) << object.name;
      const auto bytes = drive::wireBytes(
          static_cast<std::uint64_t>(static_cast<std::int64_t>(beyond)), entry.type);
      const unsigned bits = fieldbus::sizeBits(entry.type);
      const bool fits =
          entry.type == object.type &&
          beyond >= (fieldbus::isSigned(entry.type) ? -std::ldexp(1.0, static_cast<int>(bits) - 1)
                                                    : 0.0) &&
          beyond <
              std::ldexp(1.0, static_cast<int>(bits) - (fieldbus::isSigned(entry.type) ? 1 : 0));
      if (fits) {
        EXPECT_NE(dictionary.write(object.id, bytes), 0U) << object.name;
        EXPECT_EQ(entry.number, held) << object.name;
      }
    }
  }
  EXPECT_EQ(compared, 51U);
}

}  // namespace
}  // namespace cia402
