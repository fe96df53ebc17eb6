// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// recover tells the truth, and does no harm to axes that are well.
#include <gtest/gtest.h>

#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

struct Recovering : testing::Test {
  Scene scene{loadText(genericPair(", modes: [csp, csv]", ", modes: [csp, csv]"))};
  void SetUp() override {
    ASSERT_TRUE(scene.boot());
    const auto enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
  }
};

TEST_F(Recovering, LeavesAMovingAxisAloneWhileItBringsBackAnother) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "csv").success);
  scene.inject("right", "overcurrent");
  scene.stream("left", 0.5, 1s);
  scene.inject("right", "clear");
  double slowest = 1e9;
  scene.watch([&] { slowest = std::min(slowest, scene.velocity("left")); });
  const auto recovering = scene.begin(ProcedureKind::recover, "");
  scene.stream("left", 0.5, 3s);
  ASSERT_TRUE(*recovering);
  EXPECT_TRUE((*recovering)->success) << (*recovering)->message;
  EXPECT_TRUE(scene.truth("right").power_stage_on);
  EXPECT_GT(slowest, 0.48) << "rad/s of the motor of the left axis";
}

TEST_F(Recovering, DoesNotInterruptATrajectory) {
  const auto moving = ask(scene, [] {
    bus::TrajectoryCommand trajectory;
    trajectory.group = "pair";
    trajectory.joints = {"left", "right"};
    trajectory.points = {{{1.0, -1.0}, {0.0, 0.0}, {}, 2s}};
    return trajectory;
  }());
  scene.run(1s);
  ASSERT_GT(scene.velocity("left"), 0.5);
  const auto recovered = scene.procedure(ProcedureKind::recover);
  EXPECT_TRUE(recovered.success) << recovered.message;
  EXPECT_GT(scene.velocity("left"), 0.5);
  scene.run(2s);
  EXPECT_NEAR(scene.position("left"), 1.0, 0.01);
  EXPECT_NEAR(scene.position("right"), -1.0, 0.01);
}

TEST_F(Recovering, DoesNotCallAHaltedAxisWell) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt, "right").success);
  EXPECT_TRUE(scene.state("right").halted);
  EXPECT_FALSE(scene.state("left").halted);
  const auto recovered = scene.procedure(ProcedureKind::recover);
  EXPECT_FALSE(recovered.success);
  EXPECT_EQ(recovered.message, "recover done on 1 of 2 axes; right is halted: enable");
  EXPECT_NE(scene.setpoint("right", 0.1), "") << "as was said";
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
  EXPECT_TRUE(scene.procedure(ProcedureKind::recover).success);
  EXPECT_EQ(scene.setpoint("right", 0.1), "");
}

/// Drives that send their position only when it changes: their silence is no news.
TEST(Recovery, OfDrivesThatTellOnlyWhatChangesIsAnswered) {
  const std::string event =
      ", pdos: {rpdo1: [controlword, target_position],\n"
      "    tpdo1: {objects: [statusword, position_actual, mode_display], transmission: 255}}";
  Scene scene(loadText(genericPair(event, event)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  scene.run(1s);
  const auto again = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(again.success) << again.message;
  scene.inject("right", "overcurrent");
  scene.run(500ms);
  scene.inject("right", "clear");
  const auto recovered = scene.procedure(ProcedureKind::recover);
  EXPECT_TRUE(recovered.success) << recovered.message;
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  EXPECT_TRUE(scene.truth("right").power_stage_on);
}

}  // namespace
}  // namespace cia402
