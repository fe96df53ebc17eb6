// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Faults in motion: who stops, what is said, what brings the axis back.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::HasSubstr;

/// Both axes at half of a move from 0 to 2 rad.
class Faults : public testing::Test {
 protected:
  void begin(const std::string& group = {}) {
    scene.emplace(loadText(genericPair("", "", group)));
    ASSERT_TRUE(scene->boot());
    ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success);
    ASSERT_TRUE(scene->move({2.0, 2.0}, 4s).success);
    scene->run(2s);
    ASSERT_GT(scene->velocity("right"), 0.5);
  }
  std::optional<Scene> scene;
};

TEST_F(Faults, ABlockedRotorStopsItsGroupByDefault) {
  begin();
  scene->inject("left", "blocked_rotor");
  ASSERT_TRUE(scene->runUntil([&] { return scene->state("left").state == State::fault; }, 2s));
  EXPECT_THAT(scene->told(), HasSubstr("left (node 1)"));
  EXPECT_THAT(scene->told(), HasSubstr("0x8611 following error"));
  EXPECT_THAT(scene->told(), HasSubstr("check mechanics and following_error_window (6065h)"));
  scene->run(1500ms);
  EXPECT_THAT(scene->told(), HasSubstr("pair: trajectory stopped"));
  EXPECT_FALSE(scene->truth("left").power_stage_on);
  EXPECT_NEAR(scene->velocity("right"), 0.0, 1e-3);
  EXPECT_LT(scene->position("right"), 1.9) << "stopped under way";
  EXPECT_TRUE(scene->truth("right").power_stage_on) << "the healthy axis holds";
  EXPECT_LT(scene->seen("right").fastest, 1.5 * 1.1);
}

TEST_F(Faults, AnAxisFailsAloneWhereTheGroupGoesOn) {
  begin(", stop_group_on_fault: false");
  scene->inject("left", "overcurrent");
  scene->run(3s);
  EXPECT_EQ(scene->state("left").state, State::fault);
  EXPECT_THAT(scene->told(), HasSubstr("0x2310 continuous over current: load too heavy or motor "
                                       "phases wrong; check load and motor wiring"));
  EXPECT_NEAR(scene->position("right"), 2.0, 1e-3) << "went on to its goal";
  EXPECT_LT(scene->position("left"), 1.9);
  EXPECT_THAT(scene->told(), HasSubstr("pair: goal missed: left"));
}

TEST_F(Faults, ClearingLeavesItDisabledAndOneEdgeIsSent) {
  begin();
  scene->inject("left", "overcurrent");
  scene->run(1s);
  unsigned edges = 0, level = 0;
  scene->world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id != 0x201 || frame.size < 2) return;
    const unsigned bit = frame.data[0] & 0x80u;
    if (bit != 0 && level == 0) ++edges;
    level = bit;
  });
  const auto cleared = scene->procedure(ProcedureKind::clear_faults, "left");
  EXPECT_TRUE(cleared.success) << cleared.message;
  EXPECT_THAT(cleared.message, HasSubstr("the axis is disabled"));
  scene->run(1s);
  EXPECT_EQ(edges, 1u);
  EXPECT_EQ(level, 0u) << "the bit is low again";
  EXPECT_EQ(scene->state("left").state, State::switch_on_disabled);
  EXPECT_FALSE(scene->truth("left").power_stage_on);
  EXPECT_EQ(scene->state("left").error_code, 0);
}

TEST_F(Faults, OneThatPersistsIsToldAndStays) {
  begin();
  scene->inject("left", "short_circuit");
  scene->run(500ms);
  const auto cleared = scene->procedure(ProcedureKind::clear_faults, "left");
  EXPECT_FALSE(cleared.success);
  EXPECT_THAT(cleared.message, HasSubstr("0x2340"));
  const auto recovered = scene->procedure(ProcedureKind::recover, "left");
  EXPECT_FALSE(recovered.success);
  EXPECT_FALSE(scene->truth("left").power_stage_on);
  EXPECT_EQ(scene->state("left").state, State::fault);
  EXPECT_THAT(scene->procedure(ProcedureKind::enable, "left").message, HasSubstr("cannot enable"));
  EXPECT_TRUE(scene->truth("right").power_stage_on);
}

TEST_F(Faults, RecoverBringsItBackWithoutAJumpAndTheGroupMovesAgain) {
  begin();
  scene->inject("left", "overcurrent");
  scene->run(1500ms);
  scene->forget();
  const auto recovered = scene->procedure(ProcedureKind::recover, "left");
  ASSERT_TRUE(recovered.success) << recovered.message;
  scene->run(500ms);
  EXPECT_LT(scene->seen("left").travel(), 1e-3) << "not towards where the trajectory was";
  EXPECT_LT(scene->seen("right").travel(), 1e-3);
  ASSERT_TRUE(scene->move({0.0, 0.0}, 5s).success);
  scene->run(6s);
  EXPECT_NEAR(scene->position("left"), 0.0, 1e-3);
  EXPECT_NEAR(scene->position("right"), 0.0, 1e-3);
}

TEST_F(Faults, BothAxesEachTellTheirOwn) {
  begin();
  scene->inject("left", "overcurrent");
  scene->inject("right", "encoder");
  scene->run(1s);
  EXPECT_THAT(scene->axis("left").faultText(), HasSubstr("left (node 1): fault 0x2310"));
  EXPECT_THAT(scene->axis("right").faultText(), HasSubstr("right (node 2): fault 0x7305"));
  EXPECT_THAT(scene->axis("right").faultText(), HasSubstr("check the encoder cable"));
  EXPECT_FALSE(scene->truth("left").power_stage_on || scene->truth("right").power_stage_on);
  ASSERT_TRUE(scene->procedure(ProcedureKind::recover).success);
  EXPECT_TRUE(scene->truth("left").power_stage_on && scene->truth("right").power_stage_on);
}

TEST_F(Faults, AnUnknownCodeIsStillTold) {
  begin();
  scene->inject("left", "0xFF42");
  scene->run(500ms);
  EXPECT_THAT(scene->told(), HasSubstr("0xFF42"));
  EXPECT_EQ(scene->state("left").state, State::fault);
}

TEST(DamiaoFaults, AWarningStopsTheJointLikeAFault) {
  Scene scene(loadText(damiaoJoint()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.inject("joint", "overtemperature_warning");
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_FALSE(scene.state("joint").ready_for_motion);
  EXPECT_EQ(scene.state("joint").error_code, 0x4210);
  EXPECT_THAT(scene.axis("joint").faultText(),
              HasSubstr("joint (node 4): fault 0x4210 device temperature too high"));
  EXPECT_THAT(scene.told(), HasSubstr("joint (node 4): emergency: 0x4210"));
  EXPECT_THAT(scene.setpoint("joint", 0.0), HasSubstr("0x4210"));
}

}  // namespace
}  // namespace cia402
