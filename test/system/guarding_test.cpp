// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives without heartbeat, guarded by remote frames.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::HasSubstr;

TEST(Guarding, ADriveWithoutHeartbeatIsGuardedBesideOneWithIt) {
  Scene scene(loadText(genericPair(kGuarded)));
  unsigned requests = 0, answers = 0, odd = 0;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id != 0x701) return;
    requests += frame.remote ? 1U : 0U;
    answers += frame.remote ? 0U : 1U;
    odd += !frame.remote && frame.data[0] == 0x85 ? 1U : 0U;
  });
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_THAT(scene.told(), Not(HasSubstr("cannot notice")));
  requests = answers = odd = 0;
  scene.run(10s);
  EXPECT_NEAR(requests, 100, 1);
  EXPECT_EQ(answers, requests);
  EXPECT_NEAR(odd, 50, 1) << "operational, every other answer with the toggle bit";
  EXPECT_EQ(scene.state("left").health, Health::ready);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success);
}

TEST(Guarding, WhenTheMasterDiesTheGuardedDriveStopsByItself) {
  Scene scene(loadText(genericPair(kGuarded)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({2.0, -2.0}, 4s).success);
  scene.run(2s);
  ASSERT_GT(scene.velocity("left"), 0.5);
  scene.robot().port().setPowered(false);
  scene.run(300ms + 200ms);
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-2);
  scene.run(300ms);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
}

TEST(Guarding, AGuardedDriveThatFallsSilentIsLostInWordsAndTakenInAgain) {
  Scene scene(loadText(genericPair(kGuarded)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.port("left").setAttached(false);
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::lost; }, 400ms));
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): no answer to node guarding for 0.3 s"));
  EXPECT_EQ(scene.state("right").health, Health::ready);
  scene.port("left").setAttached(true);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(recovered.success) << recovered.message;
}

TEST(Guarding, APowerCycledGuardedDriveIsConfiguredAgain) {
  Scene scene(loadText(genericPair(kGuarded)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health != Health::ready; }, 2s));
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 6s)) << scene.told();
  scene.run(5s);
  EXPECT_EQ(scene.state("left").health, Health::ready) << scene.told();
}

TEST(Guarding, AGuardedDriveWhoseAnswersWereLostIsFoundAgain) {
  Scene scene(loadText(genericPair(kGuarded)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  sim::FaultRule answers;  // the drive itself is well, and hears the stop that follows
  answers.id = 0x701;
  answers.receiver = "master";
  answers.count = 3;
  scene.world().bus().faults().add(answers);
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::lost; }, 1s));
  scene.run(50ms);
  EXPECT_EQ(scene.truth("left").nmt, canopen::NmtState::stopped);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 6s)) << scene.told();
  EXPECT_FALSE(scene.truth("left").power_stage_on);
}

TEST(Guarding, ADriveWithoutGuardingObjectsIsToldToNoticeNoDeadMaster) {
  Scene scene(loadText(genericPair(", error_control: guarding")));
  ASSERT_TRUE(scene.boot()) << scene.told();  // by the book it answers remote frames all the same
  EXPECT_THAT(scene.told(),
              testing::ContainsRegex("left \\(node 1\\): [^\n]*cannot notice a dead master"));
}

}  // namespace
}  // namespace cia402
