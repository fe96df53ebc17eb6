// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Objects that shift the drive's coordinates or hold its calibration: written
// only where nothing can move, and nothing jumps afterwards.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

bus::Answer write(Scene& scene, const std::string& axis, const std::string& object,
                  const std::string& value) {
  return call(scene, bus::WriteObjectCommand{axis, object, value});
}

class SavedZero : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(scene.boot()) << scene.told();
    const auto declared = declare(scene, "joint", 1.1);
    ASSERT_TRUE(declared.success) << declared.message;
    scene.run(100ms);
    scene.forget();
  }
  bus::Answer saveZero() { return write(scene, "joint", "200B:02", "1"); }
  const drive::AxisState& state() { return scene.state("joint"); }
  Scene scene{loadText(damiaoJoint())};
};

TEST_F(SavedZero, TheAxisIsNotHomedAnyMoreAndReadsWhatTheDriveSays) {
  const std::uint32_t changes = state().zero_changes;
  const auto saved = saveZero();
  ASSERT_TRUE(saved.success) << saved.message;
  EXPECT_THAT(saved.message, AllOf(HasSubstr("joint (node 4)"), HasSubstr("200B:02 save_zero"),
                                   HasSubstr("not homed"), HasSubstr("~joint/set_position")));
  EXPECT_FALSE(state().homed);
  EXPECT_GT(state().zero_changes, changes);
  EXPECT_NEAR(state().position, 0.0, 1e-6);
}

TEST_F(SavedZero, EnablingRightAfterItMovesNothingAndPositionsNeedAZeroFirst) {
  ASSERT_TRUE(saveZero().success);
  const auto enabled = scene.procedure(ProcedureKind::enable, "joint");
  ASSERT_TRUE(enabled.success) << enabled.message;
  scene.run(500ms);
  expectNothingMoved(scene, "joint");
  EXPECT_THAT(scene.setpoint("joint", 0.1), HasSubstr("not homed"));
  scene.run(300ms);
  expectNothingMoved(scene, "joint");
  ASSERT_TRUE(declare(scene, "joint", 1.1).success);
  EXPECT_TRUE(state().homed);
  EXPECT_NEAR(state().position, 1.1, 1e-6);
  scene.run(300ms);
  expectNothingMoved(scene, "joint");
  ASSERT_EQ(scene.setpoint("joint", 1.3), "");
  scene.run(2s);
  EXPECT_NEAR(scene.position("joint"), 1.3, 2e-3);
}

/// What it told last counts from the old zero: held there, the joint would leap by 1.1 rad.
TEST(SlowFeedback, ADriveThatTellsItsPositionRarelyIsEnabledWhereItStands) {
  Scene scene(loadText(damiaoJoint(
      ", pdos: {rpdo1: [controlword, mode_of_operation, target_position], tpdo1: [statusword, "
      "mode_display], tpdo2: {objects: [position_actual], transmission: 240}}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(3s);
  ASSERT_NEAR(scene.state("joint").position, 1.1, 1e-6);
  scene.forget();
  const auto saved = write(scene, "joint", "save_zero", "1");
  ASSERT_TRUE(saved.success) << saved.message;
  EXPECT_NEAR(scene.state("joint").position, 0.0, 1e-6);
  const auto enabled = scene.procedure(ProcedureKind::enable, "joint");
  EXPECT_TRUE(enabled.success) << enabled.message;
  scene.run(1s);
  expectNothingMoved(scene, "joint");
}

TEST_F(SavedZero, NobodyEnablesTheAxisWhileItIsWritten) {
  for (const auto kind : {ProcedureKind::enable, ProcedureKind::recover, ProcedureKind::set_mode}) {
    const auto saved = ask(scene, bus::WriteObjectCommand{"joint", "save_zero", "1"});
    const auto enabled = scene.begin(kind, "joint");
    scene.run(2s);
    ASSERT_TRUE(saved->has_value() && enabled->has_value());
    EXPECT_TRUE((*saved)->success) << (*saved)->message;
    EXPECT_FALSE((*enabled)->success);
    EXPECT_THAT((*enabled)->message, HasSubstr("200B:02 save_zero is being written"));
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
  }
  expectNothingMoved(scene, "joint");
}

TEST_F(SavedZero, AnAnswerThatDoesNotComeIsTakenForAWrite) {
  scene.inject("joint", "sdo_silent");
  const auto saved = saveZero();
  EXPECT_FALSE(saved.success);
  EXPECT_THAT(saved.message, AllOf(HasSubstr("not known whether"), HasSubstr("not homed")));
  EXPECT_FALSE(state().homed);
}

TEST_F(SavedZero, WhatTheDriveRefusesChangesNothing) {
  const auto refused = write(scene, "joint", "2002:08", "nan");
  EXPECT_FALSE(refused.success);
  EXPECT_TRUE(state().homed);
  const auto absent = write(scene, "joint", "607C:00", "5");  // the drive has no such object
  EXPECT_FALSE(absent.success);
  EXPECT_TRUE(state().homed);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "joint").success);
}

TEST_F(SavedZero, AMovingOrEnabledAxisRefusesAndNamesTheService) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "joint").success);
  const auto refused = saveZero();
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message,
              AllOf(HasSubstr("joint (node 4): 200B:02 save_zero not written: "),
                    HasSubstr("disable it first"), HasSubstr("~joint/set_position")));
  EXPECT_TRUE(state().homed);
  scene.run(300ms);
  expectNothingMoved(scene, "joint");
}

TEST_F(SavedZero, AnAxisThatNobodyPowersMayStillTurn) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "joint").success);
  ASSERT_EQ(scene.setpoint("joint", -1.0), "");
  scene.run(400ms);
  ASSERT_LT(scene.velocity("joint"), -0.5);
  const auto disabling = scene.begin(ProcedureKind::disable, "joint");
  for (int i = 0; i < 20 && std::abs(scene.velocity("joint")) > 0.1; ++i) {
    EXPECT_FALSE(saveZero().success);
    scene.run(5ms);
  }
  EXPECT_TRUE(state().homed);
}

TEST(StandardCalibration, IsRefusedWhileEnabledOnADriveThatSaysNothingAboutIt) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  const std::vector<std::pair<const char*, const char*>> marked = {
      {"607C:00", "~left/home"},         {"home_offset", "~left/home"},
      {"607E:00", "`direction`"},        {"608F:01", "counts_per_turn"},
      {"6091:01", "counts_per_turn"},    {"6092:02", "counts_per_turn"},
      {"6064:00", "~left/set_position"}, {"1011:01", "~left/restore_parameters"},
  };
  for (const auto& [object, instead] : marked) {
    const auto refused = write(scene, "left", object, "1");
    EXPECT_FALSE(refused.success) << object;
    EXPECT_THAT(refused.message, AllOf(HasSubstr("left (node 1)"), HasSubstr("disable it first"),
                                       HasSubstr(instead)))
        << object;
  }
  EXPECT_TRUE(write(scene, "left", "following_error_window", "50000").success) << "not marked";
  EXPECT_TRUE(scene.state("left").homed);
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  scene.run(300ms);
  const auto written = write(scene, "left", "607C:00", "1000");
  EXPECT_TRUE(written.success) << written.message;
  EXPECT_FALSE(scene.state("left").homed);
  EXPECT_TRUE(scene.state("right").homed);
  scene.run(200ms);
  EXPECT_EQ(scene.drive("left").dictionary().find({0x607D, 1})->number, 0x80000000u) << "open";
  EXPECT_NE(scene.drive("right").dictionary().find({0x607D, 1})->number, 0x80000000u);
}

TEST(StandardCalibration, AnAbsoluteAxisDoesNotCountAsHomedAgainByLosingItsNode) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(200ms);
  ASSERT_TRUE(write(scene, "left", "607C:00", "1000").success);
  ASSERT_FALSE(scene.state("left").homed);
  scene.inject("left", "power_cycle");
  scene.run(1s);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  EXPECT_FALSE(scene.state("left").homed);
  EXPECT_THAT(scene.procedure(ProcedureKind::recover, "left").message,
              HasSubstr("left is not homed: set_position"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  EXPECT_THAT(scene.setpoint("left", 0.1), HasSubstr("not homed"));
  ASSERT_TRUE(declare(scene, "left", 0.0).success);
  EXPECT_TRUE(scene.state("left").homed);
  EXPECT_EQ(scene.setpoint("left", 0.1), "");
}

TEST(StandardCalibration, TheFactorysValuesMayHoldAnotherZero) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.state("left").homed) << "its encoder is absolute";
  const auto restored = scene.procedure(ProcedureKind::restore_parameters, "left");
  ASSERT_TRUE(restored.success) << restored.message;
  EXPECT_THAT(restored.message, HasSubstr("is disabled, not homed"));
  EXPECT_FALSE(scene.state("left").homed);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  EXPECT_THAT(scene.setpoint("left", 0.1), HasSubstr("not homed"));
  expectNothingMoved(scene, "left");
}

TEST(StandardCalibration, TheFactorysCommunicationHoldsNoZero) {
  Scene scene(loadText(genericPair(", parameters: {restore: [2]}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto restored = scene.procedure(ProcedureKind::restore_parameters, "left");
  ASSERT_TRUE(restored.success) << restored.message;
  EXPECT_TRUE(scene.state("left").homed);
}

TEST(StandardCalibration, WhatADriveAddsToItsSetPointsIsNotWritten) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  for (const char* const object : {"60B0:00", "60B1:00", "60B2:00"}) {
    const auto refused = write(scene, "left", object, "1000");
    EXPECT_FALSE(refused.success);
    EXPECT_THAT(refused.message, AllOf(HasSubstr("left (node 1)"), HasSubstr(object),
                                       HasSubstr("the drive adds it to each of its set-points")));
  }
  EXPECT_THAT(write(scene, "left", "60B0:00", "0").message, Not(HasSubstr("set-points")));
}

TEST(StandardCalibration, ADriveFarFromItsBusIsNotWritten) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.inject("left", "silent");
  ASSERT_TRUE(scene.runUntil([&] { return !allReady(scene.robot()); }, 5s));
  const auto refused = write(scene, "left", "607C:00", "1000");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("recover it first"));
}

}  // namespace
}  // namespace cia402
