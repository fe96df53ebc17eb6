// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Habits of drives in the field in the situation in which they matter, with the key of the profile
// that serves them and without it.
#include "system/field_profile.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;
using testing::Not;

constexpr char kWantsStop[] = "quirks: {fault_reset_needs_stop: 0.1}";

/// Enabled, homed by what is declared, then in fault without its cause.
struct FaultedScene : ReadyScene {
  explicit FaultedScene(const std::string& yaml) : ReadyScene(yaml) {
    inject("left", "overcurrent");
    inject("left", "clear");
    run(300ms);
    EXPECT_EQ(state("left").state, drive::State::fault);
    forget();
  }
};

TEST(FaultResetByNmtStop, ClearsWhatBit7AloneDoesNot) {
  FaultedScene scene(fieldPair("fault_reset_nmt_stop: 0.1", kWantsStop));
  bool was_stopped = false, had_power = false;
  scene.watch([&] {
    was_stopped |= scene.truth("left").nmt == canopen::NmtState::stopped;
    had_power |= scene.truth("left").power_stage_on;
  });
  const bus::Answer answer = scene.procedure(ProcedureKind::clear_faults, "left");
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_TRUE(was_stopped);
  scene.run(500ms);
  EXPECT_FALSE(had_power);
  EXPECT_LT(scene.seen("left").travel(), 1e-4);
  EXPECT_EQ(scene.state("left").state, drive::State::switch_on_disabled);
  EXPECT_EQ(scene.state("left").health, fieldbus::Health::ready);
  EXPECT_TRUE(scene.procedure(ProcedureKind::recover, "left").success);
}

TEST(FaultResetByNmtStop, LeavesNoFalseAlarmInTheLog) {
  FaultedScene scene(fieldPair("fault_reset_nmt_stop: 0.5", kWantsStop));
  const std::string before = scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::clear_faults, "left").success);
  const std::string after = scene.told().substr(before.size());
  EXPECT_THAT(after, Not(HasSubstr("did not come")));
  EXPECT_THAT(after, Not(HasSubstr("reported")));
  EXPECT_THAT(after, HasSubstr("error reset"));
}

TEST(FaultResetByNmtStop, WorksWithNodeGuarding) {
  std::string yaml =
      fieldPair("fault_reset_nmt_stop: 0.1", kWantsStop, ", error_control: guarding");
  const std::string drive = "simulation: {drive: generic_cia402";
  yaml.replace(yaml.find(drive), drive.size(), drive + "_guarding");
  FaultedScene scene(yaml);
  const bus::Answer answer = scene.procedure(ProcedureKind::clear_faults, "left");
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_EQ(scene.state("left").health, fieldbus::Health::ready);
}

TEST(FaultResetByNmtStop, IsNotTriedUnlessTheProfileSaysSo) {
  FaultedScene scene(fieldPair("", kWantsStop));
  bool was_stopped = false;
  scene.watch([&] { was_stopped |= scene.truth("left").nmt == canopen::NmtState::stopped; });
  const bus::Answer answer = scene.procedure(ProcedureKind::clear_faults, "left");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("did not clear it"));
  EXPECT_FALSE(was_stopped);
}

TEST(FaultResetByNmtStop, TellsThatItDidNotHelpEither) {
  FaultedScene scene(fieldPair("fault_reset_nmt_stop: 0.05", kWantsStop));
  const bus::Answer answer = scene.procedure(ProcedureKind::clear_faults, "left");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("(2 tries)"));
  EXPECT_EQ(scene.state("left").health, fieldbus::Health::ready);
}

TEST(FaultResetByNmtStop, LeavesTheZeroAndTheOtherAxisAlone) {
  FaultedScene scene(fieldPair("fault_reset_nmt_stop: 0.1", kWantsStop));
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "right", "pv").success);
  ASSERT_TRUE(declare(scene, "left", 0.7).success);
  const auto answer = scene.begin(ProcedureKind::clear_faults, "left");
  scene.stream("right", 0.2, 2500ms);
  EXPECT_NEAR(scene.velocity("right"), 0.2, 0.02);
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 10s));
  EXPECT_TRUE((*answer)->success) << (*answer)->message;
  EXPECT_TRUE(scene.state("left").homed);
  EXPECT_NEAR(scene.state("left").position, 0.7, 1e-3);
}

TEST(FaultResetByNmtStop, AQuickStopOfTheOthersIsServedMeanwhile) {
  FaultedScene scene(fieldPair("fault_reset_nmt_stop: 1.0", kWantsStop));
  const auto answer = scene.begin(ProcedureKind::clear_faults, "left");
  ASSERT_TRUE(
      scene.runUntil([&] { return scene.truth("left").nmt == canopen::NmtState::stopped; }, 10s));
  EXPECT_TRUE(scene.procedure(ProcedureKind::quick_stop, "right").success);
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 10s));
  EXPECT_TRUE((*answer)->success) << (*answer)->message;
}

TEST(BootInErrorPassive, IsToldInWordsAndRecoverIsTheCure) {
  Scene scene(loadText(fieldPair("", "quirks: {passive_when_alone: true}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, HasSubstr("fault 0x8120 CAN in error passive mode"));
  EXPECT_THAT(enabled.message, HasSubstr("clear_faults"));
  const bus::Answer recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(recovered.success) << recovered.message;
}

class RecoverAsTheFirstEnabling : public testing::TestWithParam<const char*> {};

TEST_P(RecoverAsTheFirstEnabling, CommandsTheModeAgain) {
  const std::string command = GetParam();
  const std::string again = command == "change" ? "through_zero" : "same";
  Scene scene(loadText(fieldPair("mode_change: {shown: enabled, again: " + again + "}",
                                 "quirks: {mode_command: " + command + "}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer answer = scene.procedure(ProcedureKind::recover);
  EXPECT_TRUE(answer.success) << answer.message;
  const bus::Answer moved = scene.move({0.2, 0.0}, 1s);
  EXPECT_TRUE(moved.success) << moved.message;
  scene.run(1500ms);
  EXPECT_NEAR(scene.position("left"), 0.2, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(ModeCommands, RecoverAsTheFirstEnabling,
                         testing::Values("enabled", "change"));

TEST(OverrunsAfterBoot, AreTakenForNoFault) {
  ReadyScene scene(fieldPair("", "communication: {overruns_at_boot: 2}"));
  EXPECT_THAT(scene.told(), HasSubstr("0x8110 CAN overrun"));
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults, "left");
  EXPECT_TRUE(cleared.success) << cleared.message;
  EXPECT_THAT(cleared.message, HasSubstr("0x8110"));
  EXPECT_EQ(scene.state("left").error_code, 0);
  EXPECT_EQ(scene.state("left").state, drive::State::operation_enabled);
}

TEST(EmergencyChatter, DoesNotFloodTheLogAndTheFaultKeepsItsName) {
  FaultedScene scene(fieldPair("", "quirks: {emergency_chatter: true}"));
  bool right = true;
  scene.watch([&] {
    right &= scene.state("left").state == drive::State::fault &&
             scene.state("left").error_code == 0x2310;
  });
  for (int i = 0; i < 10; ++i) {
    scene.inject("left", "overcurrent");
    scene.inject("left", "clear");
    scene.run(600ms);
  }
  EXPECT_TRUE(right) << scene.told();
  scene.watch({});
  ASSERT_TRUE(scene.procedure(ProcedureKind::clear_faults, "left").success);
  scene.run(6s);
  EXPECT_EQ(scene.state("left").error_code, 0);
  std::size_t lines = 0;
  for (const bus::Event& event : scene.robot().events()) {
    lines += std::string(event.text.str()).find("emergency") != std::string::npos ? 1 : 0;
  }
  EXPECT_LE(lines, 16U) << scene.told();  // of more than seventy frames
}

constexpr char kJams[] = "communication: {reset_jams_bus: 0.5}";

/// The left axis gets its factory settings back while the right one moves. @return whether the
/// right one was left alone.
bool restoresAlone(const std::string& keys) {
  ReadyScene scene(fieldPair(keys, kJams));
  EXPECT_TRUE(scene.procedure(ProcedureKind::set_mode, "right", "pv").success);
  EXPECT_TRUE(scene.procedure(ProcedureKind::disable, "left").success);
  const auto answer = scene.begin(ProcedureKind::restore_parameters, "left");
  for (int i = 0; i < 100; ++i) {
    scene.setpoint("right", 0.2);
    scene.run(20ms);
  }
  EXPECT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 30s));
  EXPECT_TRUE((*answer)->success) << (*answer)->message;
  const bool still_enabled = scene.truth("right").power_stage_on;
  scene.run(3s);
  EXPECT_LT(std::abs(scene.velocity("right")), 1e-3);
  return still_enabled && scene.state("right").health == fieldbus::Health::ready;
}

TEST(BusThatAResetPullsDown, StaysUpWhereTheProfileForbidsTheReset) {
  EXPECT_TRUE(restoresAlone("nmt_reset_node: false"));
}

TEST(BusThatAResetPullsDown, CostsTheOthersTheirOperationElse) { EXPECT_FALSE(restoresAlone("")); }

constexpr char kSaves[] = "quirks: {needs_power_cycle_to_save: true}";

TEST(PowerCycleAfterASave, IsAskedForWhereTheProfileKnowsOfIt) {
  Scene scene(loadText(fieldPair("parameters: {power_cycle_after_save: true}", kSaves)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "left").success);
  const bus::Answer saved = scene.procedure(ProcedureKind::save_parameters, "left");
  EXPECT_TRUE(saved.success) << saved.message;
  EXPECT_THAT(saved.message, HasSubstr("switch the drive off and on"));
  for (const auto kind : {ProcedureKind::enable, ProcedureKind::recover}) {
    const Time asked = scene.now();
    const bus::Answer enabled = scene.procedure(kind, "left");
    EXPECT_FALSE(enabled.success);
    EXPECT_THAT(enabled.message, HasSubstr("switch it off and on"));
    EXPECT_LT(scene.now() - asked, 500ms);
  }
  scene.inject("left", "power_cycle");
  scene.run(1s);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 20s)) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_TRUE(enabled.success) << enabled.message;
}

TEST(PowerCycleAfterASave, IsFoundOutTheHardWayElse) {
  Scene scene(loadText(fieldPair("", kSaves)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer saved = scene.procedure(ProcedureKind::save_parameters, "left");
  EXPECT_TRUE(saved.success) << saved.message;
  EXPECT_THAT(saved.message, Not(HasSubstr("switch")));
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, HasSubstr("enabling timed out: the drive has been in switched on"));
}

TEST(HaltWithTorque, OfADriveThatMissesItsMasterIsEndedByDisabling) {
  ReadyScene scene(fieldPair("", "quirks: {master_lost_holds: true}"), "pv");
  scene.stream("left", 0.3, 600ms);
  scene.port("left").setAttached(false);
  scene.run(2s);
  EXPECT_LT(std::abs(scene.velocity("left")), 1e-3);
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  scene.forget();
  scene.port("left").setAttached(true);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 20s)) << scene.told();
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("left").power_stage_on) << "found enabled, it is stopped";
  EXPECT_LT(scene.seen("left").travel(), 2e-3);
  EXPECT_TRUE(scene.procedure(ProcedureKind::recover, "left").success);
}

TEST(TextLongerThanAnnounced, IsRefusedInWordsAndCostsNothingElse) {
  ReadyScene scene(fieldPair("", "communication: {announces_four_bytes: true}"));
  const bus::Answer answer = call(scene, bus::ReadObjectCommand{"left", "1008:00"});
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("more than 4 bytes came"));
  EXPECT_TRUE(call(scene, bus::ReadObjectCommand{"left", "6064:00"}).success);
  EXPECT_EQ(scene.state("left").state, drive::State::operation_enabled);
}

TEST(TwoStatuswords, ThatDifferForAWhileAreOneOfThemToTheDriver) {
  const char* layout =
      ", pdos: {rpdo1: [controlword, mode_of_operation, target_position], "
      "tpdo1: [position_actual, mode_display], tpdo2: [statusword, velocity_actual]}";
  ReadyScene scene(fieldPair("", "communication: {stale_statusword: 0.029}", layout));
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  const bus::Answer moved = scene.move({0.3, 0.0}, 1s);
  EXPECT_TRUE(moved.success) << moved.message;
  scene.inject("left", "overcurrent");
  scene.run(100ms);
  EXPECT_EQ(scene.state("left").state, drive::State::fault);
  EXPECT_TRUE(scene.procedure(ProcedureKind::recover, "left").success);
}

}  // namespace
}  // namespace cia402
