// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What an iD286-CNFA says beside its state: bits 9 and 14, its supply, and its alarms in all the
// places where it keeps them.
#include "bus/jobs/output_job.h"
#include "system/families_faults.h"
#include "system/id286_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::size_t countOf(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++count;
  }
  return count;
}

constexpr char kBit9[] = "statusword bit 9 is 0, the drive does not listen to the controlword";

std::string local(const char* from, const char* until, const std::string& more = {}) {
  return familyJoint(kId286InPp, ", simulation: {with: {quirks: {local_from: " + std::string(from) +
                                     ", local_until: " + until + "}}}" + more);
}

TEST(Id286Remote, NothingIsCommandedWhileBit9Is0) {
  Id286Trace scene(local("0.0", "12.0", ", homing: {method: 35}"));
  ASSERT_TRUE(scene.boot(10s)) << scene.told();
  scene.clear();
  for (const ProcedureKind kind : {ProcedureKind::enable, ProcedureKind::home}) {
    const bus::Answer refused = scene.procedure(kind, "joint");
    EXPECT_FALSE(refused.success);
    EXPECT_THAT(refused.message, AllOf(HasSubstr("joint (node 1): is not enabled: "),
                                       HasSubstr(kBit9), HasSubstr("look whether")));
  }
  for (const std::uint64_t word : scene.controlwords) EXPECT_LE(word, 0x02U) << "no command";
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  ASSERT_TRUE(scene.runUntil([&] { return scene.now() >= Time{13s}; }, 20s));
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "joint");
  EXPECT_TRUE(enabled.success) << enabled.message;
}

TEST(Id286Remote, NoSetPointIsTakenOnceBit9Falls) {
  Scene scene(loadText(local("8.0", "10.0")));
  ASSERT_TRUE(scene.boot(6s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_EQ(scene.setpoint("joint", 0.2), "");
  ASSERT_TRUE(scene.runUntil([&] { return scene.now() >= Time{8100ms}; }, 10s));
  scene.forget();
  EXPECT_THAT(scene.setpoint("joint", 0.6), HasSubstr(kBit9));
  scene.run(1s);
  EXPECT_LT(scene.seen("joint").travel(), 1e-5);
  scene.run(1500ms);
  EXPECT_EQ(scene.setpoint("joint", 0.6), "");
  scene.run(2s);
  EXPECT_NEAR(scene.position("joint"), 0.6, 1e-4);
}

void writeObject(Scene& scene, const char* object, const char* value) {
  bus::WriteObjectCommand write;
  write.axis = "joint";
  write.object = object;
  write.value = value;
  const bus::Answer written = call(scene, write);
  ASSERT_TRUE(written.success) << written.message;
}

// Speed or a ramp of 0, each of those that the mode needs.
TEST(Id286ParameterOf0, IsToldAndNothingIsStarted) {
  for (const char* object : {"profile_velocity", "profile_acceleration", "profile_deceleration"}) {
    FamilyScene scene(familyJoint(kId286InPp));
    const std::string before =
        std::to_string(scene.drive("joint")
                           .dictionary()
                           .find(scene.loaded().robot.axes[0].profile->find(object)->id)
                           ->number);
    writeObject(scene, object, "0");
    scene.run(50ms);
    EXPECT_EQ(scene.truth("joint").statusword & 0x4000, 0x4000);
    scene.forget();
    EXPECT_THAT(scene.setpoint("joint", 0.4),
                AllOf(HasSubstr("statusword bit 14 is 1, it says that a parameter is 0"),
                      HasSubstr("6081h, 6083h, 6084h")));
    scene.run(500ms);
    EXPECT_LT(scene.seen("joint").travel(), 1e-5);
    writeObject(scene, object, before.c_str());
    scene.run(50ms);
    EXPECT_EQ(scene.setpoint("joint", 0.4), "");
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), 0.4, 1e-4);
  }
}

// The driver leaves the object alone, and it is 0.
TEST(Id286ParameterOf0, EndsASearchBeforeItBegins) {
  Id286Trace scene(familyJoint(
      kId286InPp,
      ", lacks: [homing_zero_velocity], homing: {method: 17, search_velocity: 0.4, acceleration: "
      "2.0}, simulation: {lower_limit_switch: -0.4, with: {dictionary: [[0x6099, 2, "
      "homing_slow_speed, uint32, rw, r, 0, 0, 2147483647]]}}"));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.clear();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, HasSubstr("statusword bit 14 is 1, it says that a parameter is 0"));
  for (const std::uint64_t word : scene.controlwords) EXPECT_EQ(word & 0x10, 0U) << "no start";
  EXPECT_LT(scene.seen("joint").travel(), 1e-5);
}

TEST(Id286ParameterOf0, IsRefusedInTheFile) {
  for (const auto& [what, by] : {std::pair("velocity: 0.8", "velocity: 0.0"),
                                 std::pair("acceleration: 4.0", "acceleration: 0.0")}) {
    Problems problems;
    config::loadRobot(YAML::Load(replaced(familyJoint(kId286InPp), what, by)),
                      config::profilesIn({test::configFolder() + "/drives"}), problems);
    EXPECT_THAT(problems.text(), HasSubstr("axes/joint/limits/"));
  }
}

// Its own alarms come at 18 V and 85 V only [L503-504].
TEST(Id286Supply, OutsideOf24To48VoltsIsWarnedOfOnceEachTime) {
  FamilyScene scene(familyJoint(kId286InPp));
  const auto supply = [&](std::uint64_t hundredths) {
    scene.drive("joint").dictionary().find({0x2065, 0})->number = hundredths;
    scene.run(2500ms);
  };
  supply(2400);
  supply(4800);
  EXPECT_THAT(scene.told(), Not(HasSubstr("bus_voltage")));
  supply(2399);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("joint (node 1): bus_voltage (2065:00) is 23.99, "
                                            "outside 24 to 48: the supply is not"),
                                  HasSubstr("check the supply")));
  EXPECT_EQ(countOf(scene.told(), "outside 24 to 48"), 1U);
  supply(3600);
  EXPECT_THAT(scene.told(), HasSubstr("bus_voltage (2065:00) is 36, within 24 to 48 again"));
  supply(4801);
  EXPECT_EQ(countOf(scene.told(), "outside 24 to 48"), 2U);
  EXPECT_EQ(scene.state("joint").state, State::operation_enabled) << "it only tells";
}

// 1001h, 206Ch and 1003h at each alarm of the maker's table.
TEST(Id286Alarms, AreReadWhereTheDriveKeepsThemAndToldInWords) {
  FamilyScene scene(familyJoint(kId286InPp));
  for (const FamilyAlarm& alarm : id286Faults()) {
    if (alarm.ends == Ends::by_power_cycle) continue;
    const std::size_t before = scene.told().size();
    scene.inject("joint", alarm.name);
    scene.run(1500ms);
    const std::string told = scene.told().substr(before);
    EXPECT_THAT(told, AllOf(HasSubstr("joint (node 1): at this fault the drive holds 1001:00 = 0x"),
                            HasSubstr("(generic"),
                            HasSubstr("206C:00 alarm_code = " + std::string(alarm.code)),
                            HasSubstr("1003:01 = " + std::string(alarm.code))))
        << alarm.name;
    EXPECT_EQ(countOf(told, "at this fault"), 1U) << alarm.name;
    scene.mustSucceed(ProcedureKind::clear_faults);
    scene.mustSucceed(ProcedureKind::enable);
  }
}

TEST(Id286Alarms, SayByTheirRegisterOfWhichKindTheyAre) {
  for (const auto& [name, kind] : {std::pair("over_current", "0x03 (generic, current)"),
                                   std::pair("over_voltage", "0x05 (generic, voltage)"),
                                   std::pair("over_temperature", "0x09 (generic, temperature)"),
                                   std::pair("master_lost", "0x11 (generic, communication)"),
                                   std::pair("following_error", "0x21 (generic, profile)"),
                                   std::pair("encoder", "0x81 (generic, the maker's own)")}) {
    FamilyScene scene(familyJoint(kId286InPp));
    scene.inject("joint", name);
    scene.run(500ms);
    EXPECT_THAT(scene.told(), HasSubstr("1001:00 = " + std::string(kind))) << name;
  }
}

// Warnings are single bits of the high byte, which fit beside an alarm.
TEST(Id286Alarms, ThatStandTogetherInOneCodeAreBothTold) {
  FamilyScene scene(familyJoint(kId286InPp));
  scene.inject("joint", "0x0819");
  scene.run(500ms);
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr("fault 0x0819 following error: blocked"),
                    HasSubstr(", and warning: positive limit: limit switch or software limit")));
  scene.mustSucceed(ProcedureKind::clear_faults);
  scene.inject("joint", "0x3000");
  scene.run(500ms);
  EXPECT_THAT(scene.axis("joint").faultText(), AllOf(HasSubstr("warning: negative limit"),
                                                     HasSubstr(", and warning: homing failed")));
  scene.mustSucceed(ProcedureKind::clear_faults);
  scene.inject("joint", "0x0822");  // 22h is no alarm of its table
  scene.run(500ms);
  EXPECT_THAT(scene.axis("joint").faultText(), Not(HasSubstr("positive limit")));
}

constexpr char kWired[] =
    ", inputs: {door: {object: digital_inputs, bit: 0}, part: {object: digital_inputs, bit: 2, "
    "active_low: true}}, outputs: {lamp: {object: digital_outputs, bit: 3, mask: {object: "
    "digital_outputs_mask, bit: 3}}, valve: {object: digital_outputs, bit: 17}}";

// Which bit is what is not printed: the robot's file says what is wired where.
TEST(Id286Terminals, HaveTheNamesThatTheRobotsFileGivesThem) {
  Scene scene(loadText(
      familyJoint(kId286InPp, std::string(kWired) + ", simulation: {lower_limit_switch: 0.1}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto set = scene.call(bus::SetOutputsCommand{"joint", {"lamp"}, {true}});
  EXPECT_TRUE(set.success) << set.message;
  EXPECT_EQ(set.message, "joint (node 1): lamp on");
  EXPECT_EQ(scene.truth("joint").outputs, 0x8U);
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x60FE, 1})->number, 0x8U);
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x60FE, 2})->number, 0x8U);
  EXPECT_TRUE(scene.call(bus::SetOutputsCommand{"joint", {"valve"}, {true}}).success);
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x60FE, 1})->number, 0x20008U);
  EXPECT_TRUE(scene.call(bus::SetOutputsCommand{"joint", {"lamp"}, {false}}).success);
  EXPECT_EQ(scene.truth("joint").outputs, 0U);
  // On the negative limit switch, which the simulated drive shows as bit 0; bit 2 is low.
  const bus::ObjectAnswer read = scene.call(bus::ReadObjectCommand{"joint", "digital_inputs"});
  EXPECT_TRUE(read.success) << read.message;
  EXPECT_THAT(read.message, AllOf(HasSubstr("door"), HasSubstr("part")));
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("joint").digital_inputs_valid; }, 100ms));
  EXPECT_EQ(scene.state("joint").digital_inputs, 1U);
  const auto unknown = scene.call(bus::SetOutputsCommand{"joint", {"horn"}, {true}});
  EXPECT_FALSE(unknown.success);
}

TEST(Id286Terminals, GetTheFunctionsAndTheLogicOfTheFile) {
  Scene scene(loadText(familyJoint(
      kId286InPp,
      ", write: [{object: input_1_function, raw: 3}, {object: input_2_function, raw: 4},"
      " {object: input_3_function, raw: 5}, {object: input_4_function, raw: 6},"
      " {object: input_5_function, raw: 7}, {object: input_6_function, raw: 8},"
      " {object: input_7_function, raw: 9}, {object: input_8_function, raw: 23},"
      " {object: output_1_function, raw: 102}, {object: output_2_function, raw: 103},"
      " {object: output_3_function, raw: 104}, {object: output_4_function, raw: 105},"
      " {object: output_5_function, raw: 109}, {object: input_logic, raw: 5},"
      " {object: output_logic, raw: 2}]")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto number = [&](std::uint16_t index, std::uint8_t sub) {
    return scene.drive("joint").dictionary().find({index, sub})->number;
  };
  const std::uint64_t inputs[] = {3, 4, 5, 6, 7, 8, 9, 23}, outputs[] = {102, 103, 104, 105, 109};
  for (std::uint8_t i = 0; i < 8; ++i) {
    EXPECT_EQ(number(0x2190, static_cast<std::uint8_t>(i + 1)), inputs[i]);
  }
  for (std::uint8_t i = 0; i < 5; ++i) {
    EXPECT_EQ(number(0x21A4, static_cast<std::uint8_t>(i + 1)), outputs[i]);
  }
  EXPECT_EQ(number(0x21AD, 0), 5U);
  EXPECT_EQ(number(0x21AE, 0), 2U);
}

TEST(Id286Terminals, ThatAreWiredToNothingAreRefusedInTheFile) {
  Problems problems;
  config::loadRobot(
      YAML::Load(familyJoint(kId286InPp,
                             ", inputs: {door: {object: doors, bit: 0}}, outputs: {lamp: {object: "
                             "digital_outputs, bit: 32}}")),
      config::profilesIn({test::configFolder() + "/drives"}), problems);
  EXPECT_THAT(problems.text(), AllOf(HasSubstr("axes/joint/inputs/door/object"),
                                     HasSubstr("axes/joint/outputs/lamp/bit")));
}

}  // namespace
}  // namespace cia402
