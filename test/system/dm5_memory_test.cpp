// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Parameters of the DM5 by the names of its manual, its memory of faults, the fault of a new
// encoder battery, the time of its brake, and the words of its state machine.
#include "bus/canopen/history_command.h"
#include "system/families_motion.h"
#include "system/traced_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr FamilyMode kMemoryCsp{"megmeet_dm5", "8388608", "csp"},
    kMemoryPv{"megmeet_dm5", "8388608", "pv"};

bus::ObjectAnswer readDm5(Scene& scene, const std::string& object) {
  return scene.call(bus::ReadObjectCommand{"joint", object});
}
bus::Answer writeDm5(Scene& scene, const std::string& object, const std::string& value) {
  return scene.call(bus::WriteObjectCommand{"joint", object, value});
}

// Pgg.nn is 2000h + gg, sub-index nn + 1, both decimal [L3109-3112].
TEST(Dm5Names, OfTheManualAreTakenByFileAndServicesAndTold) {
  Scene scene(loadText(familyJoint(
      kMemoryCsp,
      ", write: [{object: P08.02, raw: 77}, {object: P09.38, raw: 250, type: uint16}]")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto number = [&](std::uint16_t index, std::uint8_t sub) {
    return scene.drive("joint").dictionary().find({index, sub})->number;
  };
  EXPECT_EQ(number(0x2008, 3), 77U);
  EXPECT_EQ(number(0x2009, 39), 250U);
  EXPECT_EQ(readDm5(scene, "P08.02").number, 77.0);
  EXPECT_THAT(readDm5(scene, "p12.10").message, HasSubstr("200C:0B"));
  EXPECT_THAT(readDm5(scene, "P20.15").message, AllOf(HasSubstr("2014:10"), HasSubstr("P20.15")));
  EXPECT_THAT(readDm5(scene, "position_gain").message, HasSubstr("P08.02"));
  EXPECT_THAT(readDm5(scene, "P11.09").message, HasSubstr("48 V"));
  for (const auto& [name, index, sub] :
       {std::tuple("P03.12", 0x2003, 13), std::tuple("P10.07", 0x200A, 8),
        std::tuple("P12.08", 0x200C, 9), std::tuple("P23.06", 0x2017, 7)}) {
    const bus::Answer written = writeDm5(scene, name, "210");
    EXPECT_TRUE(written.success) << name << ": " << written.message;
    EXPECT_EQ(number(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)), 210U);
  }
  for (const char* none : {"P24.00", "P0A.00", "H08.02", "P08.2", "P08"}) {
    EXPECT_FALSE(readDm5(scene, none).success) << none;
  }
  const bus::Answer missing = writeDm5(scene, "P04.00", "1");
  EXPECT_FALSE(missing.success);
  EXPECT_THAT(missing.message, HasSubstr("P04.00"));
}

std::string pastFaults(Scene& scene) {
  const bus::HistoryAnswer answer = scene.call(bus::ErrorHistoryCommand{"joint"});
  EXPECT_TRUE(answer.success) << answer.message;
  return answer.message;
}

/// A fault with what the monitors said when it came, and its end.
void sufferFault(Scene& scene, const char* fault, unsigned volts, unsigned tenths) {
  scene.drive("joint").dictionary().find({0x200B, 10})->number = volts;
  scene.drive("joint").dictionary().find({0x200B, 32})->number = tenths;
  scene.inject("joint", fault);
  scene.run(300ms);
  EXPECT_TRUE(scene.procedure(ProcedureKind::clear_faults).success) << scene.told();
}

// P10.18 to P10.20 hold the numbers of Er., the newest first, P10.21 on what was so then.
TEST(Dm5FaultMemory, IsReadWithWhatWasSoWhenAFaultCame) {
  Scene scene(loadText(familyJoint(kMemoryCsp, ", simulation: {initial_position: 0.5}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  EXPECT_THAT(pastFaults(scene), HasSubstr("past faults (fault_last (200A:13)): empty"));
  sufferFault(scene, "overvoltage", 71, 301);
  const std::string one = pastFaults(scene);
  for (const char* kept : {"current_v", "current_w", "current_d_command", "current_q_command",
                           "current_d", "current_q", "speed", "inputs", "outputs", "status"}) {
    EXPECT_THAT(one, HasSubstr("fault_last_" + std::string(kept) + " 0")) << "read, too";
  }
  EXPECT_THAT(one,
              AllOf(HasSubstr("0xFF02 supply over-voltage (Er.002) ("),
                    HasSubstr("fault_last_bus_voltage 71 V"), HasSubstr("fault_last_position 0.5"),
                    HasSubstr("fault_last_temperature 30.1 degC")));
  EXPECT_THAT(one, Not(HasSubstr("fault_second")));
  sufferFault(scene, "encoder", 48, 412);
  sufferFault(scene, "undervoltage", 23, 355);
  scene.inject("joint", "motor_overload_warning");
  scene.run(300ms);
  scene.inject("joint", "clear");
  scene.inject("joint", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 20s));
  scene.run(2s);
  const std::string three = pastFaults(scene);
  const std::size_t newest = three.find("0xFF14 under-voltage while running (Er.020)");
  const std::size_t second = three.find("0xFF13 encoder fault (Er.019)");
  const std::size_t first = three.find("0xFF02 supply over-voltage (Er.002)");
  EXPECT_LT(newest, second) << three;
  EXPECT_LT(second, first) << three;
  ASSERT_NE(first, std::string::npos) << three;
  EXPECT_THAT(three, AllOf(HasSubstr("fault_last_bus_voltage 23 V"),
                           HasSubstr("fault_second_temperature 41.2 degC"),
                           HasSubstr("fault_first_bus_voltage 71 V"), Not(HasSubstr("0xFF0C"))));
  sufferFault(scene, "stalled", 48, 300);
  EXPECT_THAT(pastFaults(scene), AllOf(HasSubstr("0xFF04"), Not(HasSubstr("0xFF02"))));
}

// Er.076 takes a reset by the bus where P20.13 is 1 [L3603].
TEST(Dm5NewBattery, IsClearedOnceP2013IsWritten) {
  Scene scene(loadText(familyJoint(kMemoryCsp)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.inject("joint", "battery_lost");
  scene.run(300ms);
  const bus::Answer refused = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("0xFF4C encoder battery was lost (Er.076)"),
                                     HasSubstr("write 1 to er076_reset_by_bus (P20.13), then "
                                               "clear_faults")));
  const bus::Answer written = writeDm5(scene, "er076_reset_by_bus", "1");
  EXPECT_TRUE(written.success) << written.message;
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_TRUE(cleared.success) << cleared.message;
  EXPECT_EQ(scene.axis("joint").faultText(), "");
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
}

TEST(Dm5NewBattery, IsClearedAtOnceWhereTheFileHasP2013) {
  Scene scene(loadText(familyJoint(kMemoryCsp, ", write: [{object: P20.13, raw: 1}]")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.inject("joint", "battery_lost");
  scene.run(300ms);
  EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("Er.076"));
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_TRUE(cleared.success) << cleared.message;
}

/// A drive with a brake: P02.12 = 0 is a speed that no motor is below, so P02.13 always runs.
std::string brakedJoint(unsigned milliseconds, const std::string& more = {}) {
  return familyJoint(kMemoryPv, more +
                                    ", write: [{object: brake_fitted, raw: 1}, {object: "
                                    "brake_speed, raw: 0}, {object: brake_wait, raw: " +
                                    std::to_string(milliseconds) + "}]");
}

// From the command until the power goes: P02.13 and 50 ms [L1402-1416].
TEST(Dm5BrakeWait, IsReadAndAddedToTheTimeOfDisabling) {
  for (const unsigned wait : {500U, 12000U}) {
    for (const ProcedureKind kind : {ProcedureKind::disable, ProcedureKind::quick_stop}) {
      FamilyScene scene(brakedJoint(wait));
      scene.stream("joint", 0.3, 300ms);
      scene.stream("joint", 0.0, 300ms);
      const Time asked = scene.now();
      const bus::Answer done = scene.procedure(kind, "joint");
      EXPECT_TRUE(done.success) << done.message;
      EXPECT_THAT(done.message, Not(HasSubstr("stayed in quick stop active")));
      EXPECT_NEAR(toSeconds(scene.now() - asked), 1e-3 * wait + 0.05, 0.06) << wait;
      EXPECT_FALSE(scene.truth("joint").power_stage_on);
      EXPECT_EQ(scene.state("joint").state, State::switch_on_disabled);
    }
  }
}

// The brake closes at P02.12, which is 10 rpm from the factory, and the power goes 50 ms later; or,
// of a motor that stood, after P02.11.
TEST(Dm5BrakeWait, IsNotWaitedForByAMotorThatIsSlowEnough) {
  FamilyScene scene(familyJoint(kMemoryPv, ", write: [{object: brake_fitted, raw: 1}]"));
  scene.stream("joint", 0.6, 500ms);
  const Time moving = scene.now();
  scene.mustSucceed(ProcedureKind::disable);
  // 0.6 rad/s end by 8 rad/s^2 within 75 ms.
  EXPECT_NEAR(toSeconds(scene.now() - moving), 0.125, 0.04);
  scene.mustSucceed(ProcedureKind::enable);
  const Time standing = scene.now();
  scene.mustSucceed(ProcedureKind::disable);
  EXPECT_NEAR(toSeconds(scene.now() - standing), 0.15, 0.03);
}

/// Controlwords that left for the node, each once where it changed.
std::vector<std::string> dm5Words(const TracedScene& scene) {
  std::vector<std::string> words;
  for (const std::string& line : scene.beginning("201 ")) {
    const std::string word = line.substr(4, 5);
    if (words.empty() || words.back() != word) words.push_back(word);
  }
  return words;
}

/// Statusword bits 0 to 6 that the motor's drive went through, each once where it changed.
struct WordsAndStates : TracedScene {
  explicit WordsAndStates(const std::string& yaml) : TracedScene(yaml) {
    watch([this] {
      const unsigned state = truth("joint").statusword & 0x6F;
      if (states.empty() || states.back() != state) states.push_back(state);
    });
  }
  void beginAnew() {
    clear();
    states.assign(1, truth("joint").statusword & 0x6F);
  }
  std::vector<unsigned> states;
};

// Bits 8, 14 and 15 are the maker's, and mean nothing [L1741-1767]: here they change all the time.
TEST(Dm5Transitions, AreSeenWhateverTheMakersBitsAre) {
  FamilyScene scene(
      familyJoint(kMemoryPv, ", simulation: {with: {quirks: {vendor_bits: 0xC100}}}"));
  unsigned seen = 0, clear = 0;
  scene.watch([&] {
    seen |= scene.truth("joint").statusword & 0xC100U;
    clear |= ~scene.truth("joint").statusword & 0xC100U;
  });
  scene.stream("joint", 0.4, 300ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.4, 3e-3);
  scene.mustSucceed(ProcedureKind::quick_stop);
  scene.mustSucceed(ProcedureKind::enable);
  scene.mustSucceed(ProcedureKind::disable);
  scene.run(300ms);
  EXPECT_EQ(seen & clear, 0xC100U);
  EXPECT_EQ(scene.state("joint").state, State::switch_on_disabled);
}

// Taken back on the way up: 7 out of ready to switch on.
TEST(Dm5Transitions, UpwardsAreTakenBack) {
  WordsAndStates scene(familyJoint(kMemoryPv,
                                   ", simulation: {with: {state_machine: "
                                   "{enable_in_one_step: false}}}"));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.beginAnew();
  (void)scene.begin(ProcedureKind::enable, "joint");
  ASSERT_TRUE(scene.runUntil([&] { return scene.states.back() == 0x21U; }, 2s));
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "joint").success) << scene.told();
  EXPECT_TRUE(inOrder(dm5Words(scene), {"06 00", "00 00"}));
  EXPECT_THAT(scene.states, testing::ElementsAre(0x40U, 0x21U, 0x40U));
}

// 2, 3, 4 up, 5 and 10 down; 11 and 12; 13 to 15; each by its word [L1655-1718].
TEST(Dm5Transitions, AreCommandedByTheirWordsAndSeenAtTheDrive) {
  WordsAndStates scene(familyJoint(kMemoryPv,
                                   ", simulation: {with: {state_machine: "
                                   "{enable_in_one_step: false}}}"));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.beginAnew();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  EXPECT_TRUE(inOrder(dm5Words(scene), {"06 00", "07 00", "0F 00"}));
  EXPECT_THAT(scene.states, testing::ElementsAre(0x40U, 0x21U, 0x23U, 0x27U));  // 2, 3, 4
  scene.beginAnew();
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success) << scene.told();
  EXPECT_TRUE(inOrder(dm5Words(scene), {"07 00", "00 00"}));  // 5, 10
  EXPECT_THAT(scene.states, testing::ElementsAre(0x27U, 0x23U, 0x40U));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.stream("joint", 0.4, 300ms);
  scene.beginAnew();
  ASSERT_TRUE(scene.procedure(ProcedureKind::quick_stop).success) << scene.told();
  EXPECT_TRUE(inOrder(dm5Words(scene), {"02 00"}));  // 11, and 12 by itself
  EXPECT_THAT(scene.states, testing::ElementsAre(0x27U, 0x07U, 0x40U));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.inject("joint", "overvoltage");  // 13, 14
  scene.run(300ms);
  EXPECT_EQ(scene.truth("joint").statusword & 0x4F, 0x08);
  scene.beginAnew();
  ASSERT_TRUE(scene.procedure(ProcedureKind::clear_faults).success) << scene.told();
  EXPECT_TRUE(inOrder(dm5Words(scene), {"80 00"}));  // 15
  EXPECT_THAT(scene.states, testing::ElementsAre(0x08U, 0x40U));
}

}  // namespace
}  // namespace cia402
