// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Two axes in one drive (CiA 402-2): what each does for itself, and what is done to both. Judged by
// the motors.
#include "system/field_profile.h"

namespace cia402 {
namespace {

using drive::ProcedureKind;
using testing::HasSubstr;
using testing::Not;

/// Axes 0 and 1 of node 1, and an axis of its own at node 2.
std::string dual(const std::string& left = {}, const std::string& right = {}) {
  return "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "defaults: {drive: generic_cia402, counts_per_turn: 131072, gear_ratio: 100.0,\n"
         "  rated_torque: 0.64, command_timeout: 0.2, mode: cyclic_position,\n"
         "  limits: {lower: -2.5, upper: 2.5, velocity: 1.5, acceleration: 4.0, jerk: 40.0,\n"
         "           effort: 120.0}}\n"
         "axes:\n"
         "  left: {node_id: 1, device_axis: 0, simulation: {drive: generic_cia402_dual}" +
         left +
         "}\n"
         "  right: {node_id: 1, device_axis: 1" +
         right +
         "}\n"
         "  other: {node_id: 2}\n"
         "groups:\n"
         "  pair: {joints: [left, right], stop_group_on_fault: false}\n"
         "  rest: {joints: [other]}\n";
}

struct TwoAxes : testing::Test {
  explicit TwoAxes(const std::string& yaml = dual()) : scene(loadText(yaml)) {
    EXPECT_TRUE(scene.boot()) << scene.told();
  }
  void enableAll() {
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
  }
  std::string recover(const std::string& name) {
    const bus::Answer answer = scene.procedure(ProcedureKind::recover, name);
    EXPECT_TRUE(answer.success) << answer.message;
    return answer.message;
  }

  Scene scene;
};

TEST_F(TwoAxes, MoveTogetherEachToItsOwnGoal) {
  enableAll();
  ASSERT_TRUE(scene.move({0.5, -0.25}, std::chrono::seconds(2)).success);
  scene.run(std::chrono::seconds(3));
  EXPECT_NEAR(scene.position("left"), 0.5, 0.001);
  EXPECT_NEAR(scene.position("right"), -0.25, 0.001);
  EXPECT_NEAR(scene.position("other"), 0.0, 0.001);
  EXPECT_NEAR(scene.state("right").position, -0.25, 0.001);
}

TEST_F(TwoAxes, OneIsEnabledWithoutTheOther) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_TRUE(scene.truth("right").power_stage_on);
  scene.stream("right", 0.1, std::chrono::milliseconds(600));
  EXPECT_NEAR(scene.position("right"), 0.1, 0.01);
  EXPECT_NEAR(scene.position("left"), 0.0, 1e-6);
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "right").success);
  EXPECT_FALSE(scene.truth("right").power_stage_on);
}

TEST_F(TwoAxes, OneFaultsAndTheOtherGoesOn) {
  enableAll();
  ASSERT_TRUE(scene.move({1.0, 1.0}, std::chrono::seconds(4)).success);
  scene.run(std::chrono::milliseconds(1500));
  scene.inject("right", "overcurrent");
  scene.run(std::chrono::seconds(4));
  EXPECT_EQ(scene.state("right").state, drive::State::fault);
  EXPECT_EQ(scene.state("left").state, drive::State::operation_enabled);
  EXPECT_NEAR(scene.position("left"), 1.0, 0.001) << "to its goal";
  EXPECT_LT(scene.position("right"), 0.9);
  EXPECT_FALSE(scene.truth("right").moving);
  EXPECT_EQ(scene.axis("left").faultText(), "") << "the EMCY was not about this one";
  EXPECT_THAT(scene.axis("right").faultText(), HasSubstr("right (node 1, axis 1): fault 0x2310"));
  ASSERT_EQ(scene.robot().emergencies().size(), 1U) << "told once";

  const Scene::Seen before = scene.seen("left");
  const std::string answer = recover("right");
  EXPECT_THAT(answer, HasSubstr("; in the same drive: left (operation enabled)"));
  EXPECT_THAT(answer, Not(HasSubstr("booted")));
  EXPECT_EQ(scene.state("right").state, drive::State::operation_enabled);
  EXPECT_EQ(scene.state("left").state, drive::State::operation_enabled);
  EXPECT_NEAR(scene.seen("left").highest, before.highest, 0.001);
}

TEST_F(TwoAxes, RecoverThatBootsTheDriveSaysSoForBoth) {
  enableAll();
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("right").health != fieldbus::Health::ready; },
                             std::chrono::seconds(5)));
  const std::string answer = recover("left");
  EXPECT_THAT(answer, HasSubstr("in the same drive: right (switch on disabled)"));
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  EXPECT_FALSE(scene.truth("right").power_stage_on) << "nobody asked for it";
  recover("right");
  EXPECT_TRUE(scene.truth("right").power_stage_on);
}

TEST_F(TwoAxes, NothingIsDoneToTheDriveWhileTheOtherIsUnderPower) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
  for (const ProcedureKind kind :
       {ProcedureKind::save_parameters, ProcedureKind::restore_parameters}) {
    const bus::Answer answer = scene.procedure(kind, "left");
    EXPECT_FALSE(answer.success);
    EXPECT_THAT(answer.message,
                HasSubstr("right, in the same drive, may be under power: disable it first"));
  }
  for (const char* command : {"stop", "pre_operational", "reset_node", "reset_communication"}) {
    const bus::Answer answer = scene.call(bus::NmtServiceCommand{"left", command});
    EXPECT_FALSE(answer.success) << command;
    EXPECT_THAT(answer.message,
                HasSubstr("right, in the same drive, may be under power: disable it first"));
  }
  EXPECT_TRUE(scene.truth("right").power_stage_on);
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "right").success);
  const bus::Answer restored = scene.procedure(ProcedureKind::restore_parameters, "left");
  EXPECT_TRUE(restored.success) << restored.message;
  EXPECT_THAT(restored.message, HasSubstr("; in the same drive: right (no statusword yet)"));
  EXPECT_FALSE(scene.state("left").homed);
  EXPECT_FALSE(scene.state("right").homed) << "its parameters are others, too";
  const bus::Answer reset = scene.call(bus::NmtServiceCommand{"left", "reset_node"});
  EXPECT_TRUE(reset.success) << reset.message;
  EXPECT_THAT(reset.message, HasSubstr("in the same drive: right"));
}

TEST_F(TwoAxes, MemoryAndOtherProceduresOfOneDriveDoNotGoTogether) {
  const auto setting = scene.begin(ProcedureKind::set_position, "right");
  const bus::Answer refused = scene.procedure(ProcedureKind::restore_parameters, "left");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("set_position runs on right, in the same drive"));
  scene.run(std::chrono::seconds(1));
  ASSERT_TRUE(setting->has_value());
  EXPECT_TRUE((*setting)->success) << (*setting)->message;
  EXPECT_TRUE(scene.procedure(ProcedureKind::restore_parameters, "left").success);
}

TEST_F(TwoAxes, NobodyMovesOneByTheNameOfTheOther) {
  enableAll();
  const double left = scene.position("left");
  const bus::Answer refused = scene.call(bus::WriteObjectCommand{"right", "6040:00", "0"});
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message,
              HasSubstr("it is of axis 0 of the drive (CiA 402-2), and this is axis 1"));
  EXPECT_FALSE(scene.call(bus::WriteObjectCommand{"left", "6860:00", "3"}).success);
  EXPECT_FALSE(scene.call(bus::WriteObjectCommand{"other", "6840:00", "0"}).success)
      << "of an axis that is not configured";
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  EXPECT_NEAR(scene.position("left"), left, 1e-6);
  const bus::Answer offset = scene.call(bus::WriteObjectCommand{"right", "68B0:00 i32", "100"});
  EXPECT_THAT(offset.message, HasSubstr("the drive adds it to each of its set-points"));
  const auto read = scene.call(bus::ReadObjectCommand{"right", "statusword"});
  EXPECT_TRUE(read.success) << read.message;
  EXPECT_THAT(read.message, HasSubstr("6841:00"));
}

TEST_F(TwoAxes, ALostDriveTakesBothAndBringsBothBackDisabled) {
  enableAll();
  scene.port("left").setPowered(false);
  ASSERT_TRUE(scene.runUntil(
      [&] {
        return scene.state("left").health == fieldbus::Health::lost &&
               scene.state("right").health == fieldbus::Health::lost;
      },
      std::chrono::seconds(3)));
  EXPECT_EQ(scene.state("other").state, drive::State::operation_enabled);
  scene.run(std::chrono::seconds(2));
  EXPECT_FALSE(scene.truth("left").power_stage_on) << "its own reaction to the lost master";
  EXPECT_FALSE(scene.truth("right").power_stage_on);
  scene.port("left").setPowered(true);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, std::chrono::seconds(40)))
      << scene.told();
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_FALSE(scene.truth("right").power_stage_on);
}

struct TwoHomedAxes : TwoAxes {
  TwoHomedAxes()
      : TwoAxes(dual(", homing: {method: 37, offset: 0.2, search_velocity: 0.1, zero_velocity: "
                     "0.1, acceleration: 1.0}",
                     ", homing: {method: 37, offset: -0.3, search_velocity: 0.1, zero_velocity: "
                     "0.1, acceleration: 1.0}")) {}
};

TEST_F(TwoHomedAxes, EachHasItsOwnZeroAndRestoreTakesBoth) {
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  ASSERT_TRUE(homed.success) << homed.message;
  EXPECT_NEAR(scene.state("left").position, 0.2, 0.001);
  EXPECT_NEAR(scene.state("right").position, -0.3, 0.001);
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  const bus::Answer restored = scene.procedure(ProcedureKind::restore_parameters, "left");
  ASSERT_TRUE(restored.success) << restored.message;
  EXPECT_FALSE(scene.state("left").homed);
  EXPECT_FALSE(scene.state("right").homed) << "its home offset went with the drive's memory";
}

TEST_F(TwoAxes, ADriveIsNotBootedForOneWhileTheOtherIsUnderPower) {
  enableAll();
  sim::FaultRule unheard;  // what brings statusword and position of the right axis
  for (const canopen::PdoConfig& pdo : scene.loaded().master.nodes[0].pdos) {
    const bool first = pdo.direction == canopen::PdoDirection::tpdo && pdo.number == 65;
    if (first) unheard.id = pdo.cob_id;
  }
  ASSERT_NE(unheard.id, 0U);
  unheard.count = 1000000;
  unheard.receiver = "master";
  scene.world().bus().faults().add(unheard);
  ASSERT_TRUE(
      scene.runUntil([&] { return !scene.truth("right").power_stage_on; }, std::chrono::seconds(3)))
      << "unheard, it is stopped";
  bool powered = true, operational = true;
  scene.watch([&] {
    powered = powered && scene.truth("left").power_stage_on;
    operational = operational && scene.truth("left").nmt == canopen::NmtState::operational;
  });
  const bus::Answer refused = scene.procedure(ProcedureKind::recover, "right");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message,
              HasSubstr("the drive is not booted for it: left, in the same drive, may be under "
                        "power: disable it first, then recover"));
  EXPECT_TRUE(powered && operational);
  scene.world().bus().faults().clear();
  scene.run(std::chrono::milliseconds(100));
  recover("right");
  EXPECT_TRUE(powered && operational);
}

/// Both axes of a drive with keys of its profile and habits.
std::string dualWith(const std::string& keys, const std::string& habits) {
  std::string yaml = dual();
  const std::string drive = "drive: generic_cia402,", simulated = "drive: generic_cia402_dual";
  yaml.replace(yaml.find(simulated), simulated.size(), simulated + ", with: {" + habits + "}");
  yaml.replace(yaml.find(drive), drive.size(),
               "drive: " + writeProfile(genericProfileText() + "\n" + keys + "\n") + ",");
  const std::string other = "other: {node_id: 2";
  return yaml.replace(yaml.find(other), other.size(),
                      other + ", simulation: {drive: generic_cia402}");
}

struct FaultThatWantsNmtStop : TwoAxes {
  FaultThatWantsNmtStop()
      : TwoAxes(dualWith("fault_reset_nmt_stop: 0.1", "quirks: {fault_reset_needs_stop: 0.1}")) {}
};

TEST_F(FaultThatWantsNmtStop, IsNotClearedSoWhileTheOtherIsUnderPower) {
  enableAll();
  scene.inject("right", "overcurrent");
  scene.inject("right", "clear");
  scene.run(std::chrono::milliseconds(300));
  ASSERT_EQ(scene.state("right").state, drive::State::fault);
  bool powered = true, operational = true;
  scene.watch([&] {
    powered = powered && scene.truth("left").power_stage_on;
    operational = operational && scene.truth("left").nmt == canopen::NmtState::operational;
  });
  const bus::Answer left_out = scene.procedure(ProcedureKind::clear_faults, "right");
  EXPECT_FALSE(left_out.success);
  EXPECT_THAT(left_out.message,
              HasSubstr("NMT stop and start, after which it may be cleared, was left out: left, in "
                        "the same drive, may be under power: disable it first, then recover right "
                        "alone"));
  EXPECT_TRUE(powered && operational);
  scene.watch({});
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "left").success);
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults, "right");
  EXPECT_TRUE(cleared.success) << cleared.message;
}

struct SavedForBoth : TwoAxes {
  SavedForBoth() : TwoAxes(dualWith("parameters: {power_cycle_after_save: true}", "")) {}
};

TEST_F(SavedForBoth, ThePowerCycleIsAskedOfBoth) {
  const bus::Answer saved = scene.procedure(ProcedureKind::save_parameters, "left");
  ASSERT_TRUE(saved.success) << saved.message;
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "right");
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, HasSubstr("switch it off and on"));
  EXPECT_FALSE(scene.truth("right").power_stage_on);
}

TEST_F(TwoAxes, TheShutdownStopsAndDisablesBoth) {
  enableAll();
  ASSERT_TRUE(scene.move({1.0, 1.0}, std::chrono::seconds(4)).success);
  scene.run(std::chrono::seconds(2));
  scene.robot().network().beginShutdown(scene.now());
  ASSERT_TRUE(
      scene.runUntil([&] { return scene.robot().network().shutDown(); }, std::chrono::seconds(10)));
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_FALSE(scene.truth("right").power_stage_on);
  EXPECT_FALSE(scene.truth("left").moving || scene.truth("right").moving);
}

}  // namespace
}  // namespace cia402
