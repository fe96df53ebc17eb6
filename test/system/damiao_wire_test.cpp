// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a Damiao is told to be enabled and disabled, in which order, and what follows where it does
// not obey.
#include "system/damiao_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(DamiaoCommands, EnableByThreeWordsEachAfterItsState) {
  for (const char* mode : damiaoModes()) {
    TracedScene scene(damiaoIn(mode, ", modes: [" + std::string(mode) + "]"));
    ASSERT_TRUE(scene.boot()) << scene.told();
    scene.run(100ms);
    scene.clear();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    EXPECT_THAT(commandsSeen(scene), ElementsAre("06@40", "07@21", "0F@23")) << mode;
    EXPECT_TRUE(scene.truth("joint").power_stage_on);
  }
}

// Transition 5, then 10, at rest; from a motion a quick stop goes before, and its end is the
// drive's own transition 12.
TEST(DamiaoCommands, DisableBySmallSteps) {
  TracedScene scene(damiaoIn("profile_velocity"));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.run(200ms);
  scene.clear();
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  EXPECT_THAT(commandsSeen(scene), ElementsAre("07@27", "00@23"));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.stream("joint", 1.0, 500ms);
  scene.clear();
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  EXPECT_THAT(commandsSeen(scene), ElementsAre("02@27", "00@40"));
  EXPECT_EQ(scene.velocity("joint"), 0.0);
}

// Transition 4 takes longer than timing/state_change of the profile, 2 s.
TEST(DamiaoTimeOut, OfEnablingIsToldAndLeavesItSwitchedOff) {
  Scene scene(loadText(damiaoIn("cyclic_position", "", "quirks: {enabling_time: 4.0}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.forget();
  const Time asked = scene.now();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_LT(scene.now() - asked, 4s);
  EXPECT_THAT(enabled.message, AllOf(HasSubstr("joint (node 4)"), HasSubstr("statusword"),
                                     HasSubstr("switched on")));
  scene.run(5s);
  EXPECT_FALSE(scene.truth("joint").power_stage_on) << "it comes too late";
  EXPECT_LT(scene.seen("joint").travel(), 1e-6);
}

// 6061h shows another mode for longer than timing/mode_change of the profile, 1 s.
TEST(DamiaoTimeOut, OfAModeIsToldAndMovesNothing) {
  Scene scene(loadText(damiaoIn("cyclic_position", "", "quirks: {mode_change_time: 3.0}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.forget();
  const bus::Answer late = scene.procedure(ProcedureKind::set_mode, "joint", "position_velocity");
  EXPECT_FALSE(late.success);
  EXPECT_THAT(late.message, AllOf(HasSubstr("joint (node 4): mode"), HasSubstr("was not taken"),
                                  HasSubstr("6061:00 mode display shows")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  scene.run(4s);
  EXPECT_LT(scene.seen("joint").travel(), 1e-6);
}

/// Whatever is written there, the drive has `bits` when it is asked.
void holdsAlways(Scene& scene, fieldbus::ObjectId id, std::uint64_t bits) {
  scene.drive("joint").dictionary().onRead(id, [bits](sim::Entry& entry) {
    entry.number = bits;
    return 0U;
  });
}

TEST(DamiaoReadBack, OfAStartUpWriteEndsTheBootInWords) {
  Scene scene(loadText(damiaoIn("cyclic_position")));
  holdsAlways(scene, {0x6085, 0}, 0x461C4000);
  scene.boot(8s);
  EXPECT_THAT(scene.told(),
              AllOf(HasSubstr("the drive took"), HasSubstr("6085:00 quick_stop_deceleration"),
                    HasSubstr("but holds 0x461C4000")));
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

TEST(DamiaoReadBack, OfWhatIsWrittenBeforeEnablingRefusesIt) {
  Scene scene(loadText(damiaoIn("cyclic_position")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  holdsAlways(scene, {0x605A, 0}, 0);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message,
              AllOf(HasSubstr("the drive took 0x02 for quick_stop_option (605A:00)"),
                    HasSubstr("but holds 0x00")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

TEST(DamiaoReadBack, OfTheRampsOfAModeRefusesIt) {
  Scene scene(loadText(damiaoIn("profile_velocity")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  holdsAlways(scene, {0x6084, 0}, 0x44FA0000);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, AllOf(HasSubstr("profile_deceleration (6084:00)"),
                                     HasSubstr("but holds 0x44FA0000")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

// Before it is enabled: mode, ramps, 605Ah, limits, as floats of what the axis is given.
TEST(DamiaoSettings, StandInTheDriveBeforeItIsEnabled) {
  Scene scene(loadText(damiaoIn("position_velocity_torque")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  bool looked = false;
  scene.watch([&] {
    if (looked || !scene.truth("joint").power_stage_on) return;
    looked = true;
    EXPECT_EQ(numberIn(scene, 0x6061), 3U);
    EXPECT_EQ(numberIn(scene, 0x605A), 2U);
    EXPECT_EQ(floatIn(scene, 0x6083), 15.0);
    EXPECT_EQ(floatIn(scene, 0x6084), 15.0);
    EXPECT_EQ(floatIn(scene, 0x6085), 30.0);
    EXPECT_EQ(floatIn(scene, 0x60C5), 150.0);
    EXPECT_EQ(floatIn(scene, 0x60C6), 150.0);
    EXPECT_EQ(floatIn(scene, 0x6080), 2.0);
    EXPECT_EQ(floatIn(scene, 0x6072), 5.0);
    EXPECT_EQ(floatIn(scene, 0x6071), 5.0);
    EXPECT_EQ(floatIn(scene, 0x60FF), 2.0);
    EXPECT_EQ(floatIn(scene, 0x6081), 2.0);
    EXPECT_EQ(numberIn(scene, 0x6086), 0U);
    EXPECT_NEAR(floatIn(scene, 0x607A), 1.1, 1e-6);
  });
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  EXPECT_TRUE(looked);
}

// 200Bh:01 is the second way, where the edge of bit 7 does not do it [L92, L1137].
TEST(DamiaoFaultReset, GoesOnByTheObjectWhereTheEdgeDoesNotHelp) {
  for (const bool needed : {false, true}) {
    TracedScene scene(damiaoIn("cyclic_position", "",
                               needed ? "quirks: {fault_reset_by_object: true}" : "quirks: {}"));
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    scene.inject("joint", "encoder");
    scene.run(500ms);
    ASSERT_FALSE(scene.truth("joint").power_stage_on);
    scene.clear();
    const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
    EXPECT_TRUE(cleared.success) << cleared.message;
    EXPECT_EQ(scene.axis("joint").faultText(), "");
    const std::string write = "23 0B 20 01 01 00 00 00";
    if (needed) {
      EXPECT_THAT(scene.writes(4), Contains(write));
    } else {
      EXPECT_THAT(scene.writes(4), Not(Contains(write)));
    }
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  }
}

TEST(DamiaoFaultReset, IsTriedAFewTimesAlone) {
  TracedScene scene(damiaoIn("cyclic_position"));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.inject("joint", "hardware");  // nothing but its power resets it
  scene.run(500ms);
  scene.clear();
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_FALSE(cleared.success);
  EXPECT_THAT(cleared.message, HasSubstr("0x5530"));
  scene.run(5s);
  std::size_t edges = 0;
  for (const std::string& command : commandsSeen(scene)) {
    if (command.substr(0, 2) == "80") ++edges;
  }
  EXPECT_EQ(edges, 2U) << "before and after 200Bh:01";
}

// 603Fh, 1001h, 1003h and the EMCY of one fault, in motion.
TEST(DamiaoFaultReport, NamesCodeRegisterHistoryAndEmergency) {
  Scene scene(loadText(damiaoIn("profile_velocity")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.stream("joint", 0.5, 300ms);
  scene.inject("joint", "overcurrent");
  scene.run(1s);
  EXPECT_EQ(scene.velocity("joint"), 0.0);
  EXPECT_EQ(scene.state("joint").error_code, 0x2310);
  EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("0x2310"));
  EXPECT_THAT(scene.told(), HasSubstr("joint (node 4): emergency: 0x2310"));
  ASSERT_TRUE(scene.node("joint").lastEmergency());
  EXPECT_EQ(scene.node("joint").lastEmergency()->code, 0x2310);
  EXPECT_EQ(scene.node("joint").lastEmergency()->error_register, 0x03) << "current, and bit 0";
  const auto shown = scene.call(bus::ReadObjectCommand{"joint", "1001:00 u8"});
  EXPECT_EQ(shown.number, 3.0) << shown.message;
  const bus::HistoryAnswer history = scene.call(bus::ErrorHistoryCommand{"joint"});
  ASSERT_EQ(history.history.entries.size(), 1U) << history.message;
  EXPECT_EQ(history.history.entries[0].code, 0x2310);
  EXPECT_THAT(scene.setpoint("joint", 0.5), HasSubstr("0x2310")) << "nothing is streamed on";
  scene.run(2s);
  EXPECT_FALSE(scene.truth("joint").power_stage_on) << "not before somebody asks";
}

}  // namespace
}  // namespace cia402
