// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The controlwords and statuswords that the manual of the iD286-CNFA prints for each mode
// [L1854-1921], word by word, and what the driver makes of them.
#include "drive/axis/state_machine.h"
#include "drive/profile/status_bits.h"
#include "system/id286_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

struct Id286Words : testing::Test {
  static void enable(Id286Trace& scene) {
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    scene.run(100ms);
    scene.clear();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
    scene.run(100ms);
  }
};

TEST_F(Id286Words, OfProfilePositionAreThosePrinted) {
  Id286Trace scene(familyJoint(kId286InPp));
  ASSERT_NO_FATAL_FAILURE(enable(scene));
  EXPECT_THAT(scene.controlwords, ElementsAre(0x00, 0x06, 0x07, 0x0F));
  EXPECT_THAT(scene.statuswords, ElementsAre(0x0250, 0x0231, 0x0233, 0x8237));

  scene.clear();  // the first move, to its end; it begins with the edge of bit 5
  std::uint64_t began_by = 0;
  scene.watch([&] {
    scene.look();
    if (began_by == 0 && scene.statuswords.back() == 0x1237) began_by = scene.number(0x6040);
  });
  ASSERT_EQ(scene.setpoint("joint", 0.6), "");
  scene.run(3s);
  EXPECT_THAT(scene.controlwords, ElementsAre(0x0F, 0x2F, 0x3F, 0x0F));
  EXPECT_THAT(scene.statuswords, ElementsAre(0x8237, 0x1237, 0x1637));
  EXPECT_EQ(began_by, 0x2FU);
  EXPECT_NEAR(scene.position("joint"), 0.6, 1e-4);

  scene.clear();  // another place: bit 12 was set already
  ASSERT_EQ(scene.setpoint("joint", 2.4), "");
  scene.run(1s);
  EXPECT_THAT(
      std::vector<std::uint64_t>(scene.controlwords.begin(), scene.controlwords.begin() + 3),
      ElementsAre(0x0F, 0x2F, 0x3F));
  EXPECT_THAT(scene.statuswords, ElementsAre(0x1637, 0x1237));
  EXPECT_GT(scene.velocity("joint"), 0.3);

  scene.clear();  // bit 8 at once, bit 10 once it stands
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt).success);
  scene.run(500ms);
  EXPECT_EQ(scene.controlwords.back(), 0x10FU);
  EXPECT_THAT(scene.statuswords, ElementsAre(0x1237, 0x1337, 0x1737));
}

TEST_F(Id286Words, OfAFaultInProfilePositionAreThosePrinted) {
  Id286Trace scene(familyJoint(kId286InPp));
  ASSERT_NO_FATAL_FAILURE(enable(scene));
  ASSERT_EQ(scene.setpoint("joint", 2.0), "");
  scene.run(1s);
  scene.clear();
  scene.run(1ms);
  scene.inject("joint", "over_voltage");
  scene.run(100ms);
  EXPECT_THAT(scene.statuswords, ElementsAre(0x1237, 0x1238));
  EXPECT_EQ(scene.state("joint").state, State::fault);
  scene.run(2s);
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_TRUE(cleared.success) << cleared.message;
  EXPECT_EQ(scene.statuswords.back(), 0x0250U);
  scene.clear();  // it waits for a first set-point again
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.run(100ms);
  EXPECT_THAT(scene.statuswords, ElementsAre(0x0250, 0x0231, 0x0233, 0x8237));
}

// "Runs once enabled": here at 0, which bits 12 and 10 tell; bit 12 stays though it turns.
TEST_F(Id286Words, OfProfileVelocityAreThosePrinted) {
  Id286Trace scene(familyJoint(kId286InPv));
  ASSERT_NO_FATAL_FAILURE(enable(scene));
  EXPECT_THAT(scene.controlwords, ElementsAre(0x00, 0x06, 0x07, 0x0F));
  EXPECT_THAT(scene.statuswords, ElementsAre(0x0250, 0x0231, 0x0233, 0x1637));
  for (const double speed : {0.5, 0.3}) {
    scene.clear();
    scene.stream("joint", speed, 500ms);
    EXPECT_THAT(scene.controlwords, ElementsAre(0x0F));
    EXPECT_THAT(scene.statuswords, ElementsAre(0x1637, 0x1237, 0x1637)) << "bit 10: its speed";
    EXPECT_NEAR(scene.velocity("joint"), speed, 2e-3);
  }
  scene.clear();
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt).success);
  scene.run(500ms);
  EXPECT_EQ(scene.controlwords.back(), 0x10FU);
  EXPECT_THAT(scene.statuswords, ElementsAre(0x1637, 0x1337, 0x1737));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.stream("joint", 0.5, 500ms);
  scene.clear();
  scene.run(1ms);
  scene.inject("joint", "over_voltage");
  scene.run(100ms);
  EXPECT_THAT(scene.statuswords, ElementsAre(0x1637, 0x1638));
}

constexpr char kSearchesFarAway[] =
    ", homing: {method: 17, search_velocity: 0.4, zero_velocity: 0.05, acceleration: 2.0}"
    ", simulation: {lower_limit_switch: -2.0}";

TEST_F(Id286Words, OfHomingAreThosePrinted) {
  for (const bool fails : {false, true}) {
    Id286Trace scene(familyJoint(kId286InPp, kSearchesFarAway));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    scene.run(100ms);
    scene.clear();
    const auto homed = scene.begin(ProcedureKind::home, "joint");
    ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") < -0.35; }, 8s));
    EXPECT_THAT(scene.controlwords, ElementsAre(0x00, 0x06, 0x07, 0x0F, 0x1F));
    EXPECT_THAT(scene.statuswords, ElementsAre(0x0250, 0x0231, 0x0233, 0x8337, 0x0237));
    scene.clear();
    if (fails) {
      scene.run(1ms);
      scene.inject("joint", "over_voltage");
      scene.run(100ms);
      EXPECT_THAT(scene.statuswords, ElementsAre(0x0237, 0x0238));
      continue;
    }
    // By the drive alone, as the driver lets go of bit 4 as well.
    scene.drive("joint").dictionary().find({0x6040, 0})->number = 0x11F;
    EXPECT_TRUE(scene.procedure(ProcedureKind::halt, "joint").success);
    scene.run(500ms);
    EXPECT_THAT(scene.statuswords, ElementsAre(0x0237, 0x0337, 0x0737));
    EXPECT_FALSE((*homed)->success);
  }
}

// Bits 10 and 12 tell its end.
TEST_F(Id286Words, OfAHomeThatIsFoundHaveBits10And12) {
  Id286Trace scene(familyJoint(
      kId286InPp,
      ", homing: {method: 17, search_velocity: 0.4, zero_velocity: 0.05, acceleration: 2.0}"
      ", simulation: {lower_limit_switch: -0.4}"));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success);
  bool attained = false;
  for (const std::uint64_t word : scene.statuswords) attained = attained || word == 0x1637;
  EXPECT_TRUE(attained);
}

/// All words of the traces, and the state that each shows.
std::vector<std::pair<std::uint16_t, State>> printedWords() {
  return {{0x0250, State::switch_on_disabled},
          {0x0231, State::ready_to_switch_on},
          {0x0233, State::switched_on},
          {0x8237, State::operation_enabled},
          {0x1237, State::operation_enabled},
          {0x1637, State::operation_enabled},
          {0x1737, State::operation_enabled},
          {0x8337, State::operation_enabled},
          {0x0237, State::operation_enabled},
          {0x0737, State::operation_enabled},
          {0x1238, State::fault},
          {0x1638, State::fault},
          {0x0238, State::fault}};
}

// Bits 7, 8 and 11 to 15 say nothing of the state.
TEST(Id286States, AreThoseOfThePrintedWordsWhateverTheOtherBits) {
  constexpr unsigned kOthers[] = {7, 8, 11, 12, 13, 14, 15};
  for (const auto& [word, state] : printedWords()) {
    for (unsigned choice = 0; choice < 128; ++choice) {
      unsigned other = word;
      for (unsigned i = 0; i < 7; ++i) other ^= ((choice >> i) & 1U) << kOthers[i];
      EXPECT_EQ(drive::decodeState(static_cast<std::uint16_t>(other)), state) << std::hex << other;
    }
  }
}

TEST(Id286States, AreToldByTheNamesOfTheManual) {
  const LoadedRobot loaded = loadText(familyJointWith(kId286InPp, "[pp, pv]"));
  const drive::DriveProfile& profile = *loaded.robot.axes[0].profile;
  const auto words = [&](unsigned word, const char* mode) {
    return drive::statusBitsText(static_cast<std::uint16_t>(word), profile.mode(mode),
                                 profile.status_words);
  };
  EXPECT_EQ(words(0x0250, "profile_position"), "voltage enabled, switch on disabled, remote");
  EXPECT_EQ(words(0x0231, "profile_position"),
            "ready to switch on, voltage enabled, quick stop inactive, remote");
  EXPECT_EQ(words(0x0233, "profile_position"),
            "ready to switch on, switched on, voltage enabled, quick stop inactive, remote");
  EXPECT_THAT(words(0x8237, "profile_position"),
              AllOf(HasSubstr("operation enabled"), HasSubstr("remote, ready to be triggered")));
  EXPECT_THAT(words(0x1237, "profile_position"), HasSubstr("remote, set-point acknowledged"));
  EXPECT_THAT(words(0x1637, "profile_position"),
              HasSubstr("remote, target reached, set-point acknowledged"));
  EXPECT_THAT(words(0x1737, "profile_position"),
              HasSubstr("quick stop inactive, abnormal stop, remote, target reached"));
  EXPECT_THAT(words(0x1238, "profile_position"),
              HasSubstr("fault, voltage enabled, quick stop inactive"));
  EXPECT_THAT(words(0x1637, "profile_velocity"), HasSubstr("remote, target reached, bit 12"));
  EXPECT_THAT(words(0x8337, "homing"), HasSubstr("abnormal stop, remote, ready to be triggered"));
  EXPECT_THAT(words(0x1637, "homing"), HasSubstr("target reached, homing attained"));
  EXPECT_THAT(words(0x2237, "homing"), HasSubstr("homing error"));
  EXPECT_THAT(words(0x4237, "profile_position"), HasSubstr("a parameter is 0"));
}

}  // namespace
}  // namespace cia402
