// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Saving and restoring parameters, and NMT, on whole robots.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using canopen::NmtState;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::HasSubstr;

constexpr fieldbus::ObjectId kErrorTime{0x6066, 0};  // following error time out, ms

class ParametersScene : public testing::Test {
 protected:
  ParametersScene() : scene(loadText(genericPair())) {}
  void SetUp() override { ASSERT_TRUE(scene.boot()) << scene.told(); }
  std::uint64_t errorTime(const std::string& name) {
    return scene.drive(name).dictionary().find(kErrorTime)->number;
  }
  bus::Answer write(const std::string& value) {
    return call(scene, bus::WriteObjectCommand{"left", "6066:00", value});
  }
  bus::Answer nmt(const std::string& axis, const std::string& word) {
    return call(scene, bus::NmtServiceCommand{axis, word});
  }
  void powerCycle() {
    scene.inject("left", "power_cycle");
    ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health != Health::ready; }, 2s));
    ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 6s)) << scene.told();
  }
  Scene scene;
};

TEST_F(ParametersScene, WhatIsSavedOutlivesThePowerAndRestoringBringsTheFactorysValuesBack) {
  const std::uint64_t factory = errorTime("left");
  ASSERT_NE(factory, 77u);
  ASSERT_TRUE(write("77").success);
  powerCycle();
  EXPECT_EQ(errorTime("left"), factory) << "not saved";
  ASSERT_TRUE(write("77").success);
  const auto saved = scene.procedure(ProcedureKind::save_parameters, "left");
  ASSERT_TRUE(saved.success) << saved.message;
  powerCycle();
  EXPECT_EQ(errorTime("left"), 77u);

  const auto restored = scene.procedure(ProcedureKind::restore_parameters, "left");
  ASSERT_TRUE(restored.success) << restored.message;
  EXPECT_THAT(restored.message, HasSubstr("configured again by the driver and is disabled"));
  EXPECT_EQ(errorTime("left"), factory);
  EXPECT_EQ(scene.truth("left").nmt, NmtState::operational);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  const auto enabled = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_TRUE(enabled.success) << enabled.message;
}

TEST_F(ParametersScene, AllAxesAreSavedByOneCall) {
  const auto saved = scene.procedure(ProcedureKind::save_parameters);
  EXPECT_TRUE(saved.success);
  EXPECT_EQ(saved.message, "save_parameters done on 2 of 2 axes");
}

TEST_F(ParametersScene, AMovingRobotIsNeitherSavedNorRestoredNorReset) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({1.0, 1.0}, 2s).success);
  scene.run(500ms);
  for (const auto kind : {ProcedureKind::save_parameters, ProcedureKind::restore_parameters}) {
    EXPECT_THAT(scene.procedure(kind, "left").message, HasSubstr("disable it first"));
  }
  for (const char* word : {"stop", "pre_operational", "reset_node", "reset_communication"}) {
    EXPECT_THAT(nmt("left", word).message, HasSubstr("is not disabled"));
    EXPECT_THAT(nmt("", word).message, HasSubstr("is not disabled"));
  }
  scene.run(3s);
  EXPECT_NEAR(scene.position("left"), 1.0, 1e-3) << "it did not notice";
  EXPECT_NEAR(scene.position("right"), 1.0, 1e-3);
}

TEST_F(ParametersScene, AnAxisThatCoastsIsNeitherSavedNorRestored) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({1.0, 1.0}, 2s).success);
  scene.run(1s);
  scene.inject("left", "hardware");
  scene.run(20ms);
  ASSERT_FALSE(scene.truth("left").power_stage_on);
  for (const auto kind : {ProcedureKind::save_parameters, ProcedureKind::restore_parameters}) {
    const auto refused = scene.procedure(kind, "left");
    EXPECT_FALSE(refused.success);
    EXPECT_THAT(refused.message, HasSubstr("the axis moves; wait until it is at rest"));
    EXPECT_GT(std::fabs(scene.velocity("left")), 0.05) << "the answer is of this moment";
  }
}

TEST_F(ParametersScene, AStoppedNodeIsStoppedAndComesBackByStart) {
  const auto stopped = nmt("left", "stop");
  ASSERT_TRUE(stopped.success) << stopped.message;
  EXPECT_EQ(scene.truth("left").nmt, NmtState::stopped);
  EXPECT_EQ(scene.truth("right").nmt, NmtState::operational);
  EXPECT_FALSE(scene.procedure(ProcedureKind::enable, "left").success);
  const auto started = nmt("left", "start");
  ASSERT_TRUE(started.success) << started.message;
  EXPECT_EQ(scene.truth("left").nmt, NmtState::operational);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
}

TEST_F(ParametersScene, AllNodesAreResetByOneCommand) {
  const auto reset = nmt("", "reset_node");
  ASSERT_TRUE(reset.success) << reset.message;
  EXPECT_EQ(reset.message, "nmt reset_node done on 2 of 2 nodes");
  EXPECT_TRUE(allReady(scene.robot()));
  const auto enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
}

}  // namespace
}  // namespace cia402
