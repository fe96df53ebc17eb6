// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// set_bus_parameters of drives whose numbers count later, and stay only once they are saved.
#include "bus/canopen/bus_setting_job.h"
#include "system/families_bus_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

bus::Answer setFamilyBus(Scene& scene, unsigned node_id, unsigned bit_rate, bool confirm) {
  return scene.call(bus::SetBusParametersCommand{"joint", node_id, bit_rate, confirm});
}

/// Booted and at rest; never enabled.
struct BusParametersOf : Scene {
  explicit BusParametersOf(const FamilyMode& tested) : Scene(loadText(busJoint(tested))) {
    EXPECT_TRUE(boot(kFamilyBoot)) << told();
    run(500ms);
  }
  unsigned nodeId() { return drive("joint").device().node(); }
  /// @return whether it came back
  bool powerCycle() {
    inject("joint", "power_cycle");
    run(2s);
    return runUntil([this] { return allReady(robot()); }, 8s);
  }
};

// 200Ch:02, 1 to 127, from the next power-on [2598]; 1010h keeps it [1973].
TEST(NimotionBusParameters, OfTheNodeIdCountFromTheNextPowerOnOnceTheyAreSaved) {
  BusParametersOf scene(kBusNimotion);
  const bus::Answer asked = setFamilyBus(scene, 5, 0, false);
  EXPECT_FALSE(asked.success);
  EXPECT_THAT(asked.message, HasSubstr("can_node_id (200C:02) is 1 and would be 5"));
  EXPECT_EQ(numberIn(scene, 0x200C, 2), 1U);
  const bus::Answer set = setFamilyBus(scene, 5, 0, true);
  EXPECT_TRUE(set.success) << set.message;
  EXPECT_THAT(set.message,
              AllOf(HasSubstr("can_node_id (200C:02) was 1 and is 5"),
                    HasSubstr("counts once its power was off, and stays only after "
                              "save_parameters"),
                    HasSubstr("change `node_id` of axes/joint, and start the driver anew")));
  EXPECT_EQ(numberIn(scene, 0x200C, 2), 5U);
  EXPECT_EQ(scene.nodeId(), 1U) << "not yet";
  EXPECT_TRUE(scene.powerCycle()) << scene.told();
  EXPECT_EQ(scene.nodeId(), 1U) << "it was not saved";
  EXPECT_EQ(numberIn(scene, 0x200C, 2), 1U);
  EXPECT_TRUE(setFamilyBus(scene, 5, 0, true).success);
  EXPECT_TRUE(scene.procedure(ProcedureKind::save_parameters, "joint").success) << scene.told();
  EXPECT_FALSE(scene.powerCycle()) << "at node-ID 1";
  EXPECT_EQ(scene.nodeId(), 5U);
}

// 200Ch:03: 0x00 10 kbit/s ... 0x06 500 kbit/s, 0x07 800 kbit/s, 0x08 1 Mbit/s [377-386].
TEST(NimotionBusParameters, OfTheBitRateAreTheCodesOfTheManual) {
  BusParametersOf scene(kBusNimotion);
  const std::pair<unsigned, unsigned> codes[] = {{10000, 0},  {20000, 1},  {50000, 2},
                                                 {100000, 3}, {125000, 4}, {250000, 5},
                                                 {500000, 6}, {800000, 7}, {1000000, 8}};
  for (const auto& [rate, code] : codes) {
    const bus::Answer set = setFamilyBus(scene, 0, rate, true);
    EXPECT_TRUE(set.success) << set.message;
    EXPECT_EQ(numberIn(scene, 0x200C, 3), code) << rate;
    EXPECT_THAT(set.message, AllOf(HasSubstr("bit rate: can_bit_rate_code (200C:03)"),
                                   HasSubstr("counts once its power was off")));
  }
  EXPECT_TRUE(setFamilyBus(scene, 0, 500000, true).success);
  EXPECT_TRUE(scene.powerCycle()) << "it was not saved" << scene.told();
  EXPECT_TRUE(setFamilyBus(scene, 0, 500000, true).success);
  EXPECT_TRUE(scene.procedure(ProcedureKind::save_parameters, "joint").success) << scene.told();
  EXPECT_TRUE(allReady(scene.robot())) << "not yet";
  EXPECT_FALSE(scene.powerCycle()) << "nothing is heard of it at this bit rate any more";
  EXPECT_EQ(numberIn(scene, 0x200C, 3), 6U);
}

TEST(NimotionBusParameters, BeyondThoseOfTheManualAreRefused) {
  BusParametersOf scene(kBusNimotion);
  for (const unsigned node : {128U, 255U}) {
    EXPECT_THAT(setFamilyBus(scene, node, 0, true).message, HasSubstr("a node-ID is 1 to 127"));
  }
  EXPECT_THAT(setFamilyBus(scene, 0, 0, true).message, HasSubstr("one of them"));
  EXPECT_THAT(setFamilyBus(scene, 0, 300000, true).message,
              HasSubstr("the drive has no bit rate 300000; it has 10000, 20000, 50000"));
  EXPECT_EQ(numberIn(scene, 0x200C, 2), 1U);
  EXPECT_EQ(numberIn(scene, 0x200C, 3), 8U);
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  for (const unsigned node : {5U, 0U}) {
    const bus::Answer refused = setFamilyBus(scene, node, node == 0 ? 500000 : 0, true);
    EXPECT_FALSE(refused.success);
    EXPECT_THAT(refused.message, HasSubstr("the axis is not disabled"));
  }
  EXPECT_EQ(numberIn(scene, 0x200C, 2), 1U);
  EXPECT_EQ(numberIn(scene, 0x200C, 3), 8U);
}

// 2003h:01, 1 to 127 [L1075].
TEST(DamiaoBusParameters, OfTheNodeIdCountFromTheNextResetOnOnceTheyAreSaved) {
  BusParametersOf scene(kBusDamiao);
  for (const unsigned node : {0U, 128U, 255U}) {
    EXPECT_FALSE(setFamilyBus(scene, node, 0, true).success) << node;
  }
  EXPECT_EQ(numberIn(scene, 0x2003, 1), 1U);
  const bus::Answer set = setFamilyBus(scene, 9, 0, true);
  EXPECT_TRUE(set.success) << set.message;
  EXPECT_THAT(set.message, AllOf(HasSubstr("can_node_id (2003:01) was 1 and is 9"),
                                 HasSubstr("counts from its next reset on, and stays only after "
                                           "save_parameters")));
  EXPECT_EQ(numberIn(scene, 0x2003, 1), 9U);
  EXPECT_TRUE(scene.procedure(ProcedureKind::save_parameters, "joint").success) << scene.told();
  EXPECT_EQ(scene.nodeId(), 1U) << "not yet";
  (void)scene.ask(bus::NmtServiceCommand{"joint", "reset_node"});
  bool heard = false;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    heard = heard || (frame.id == 0x709 && frame.size == 1 && frame.data[0] == 0);
  });
  scene.run(1s);
  EXPECT_EQ(scene.nodeId(), 9U);
  EXPECT_TRUE(heard) << "its boot-up message";
}

// The driver with the changed file finds it.
TEST(DamiaoBusParameters, OfTheNodeIdAreThoseOfTheFileAfterwards) {
  Scene scene(loadText(busRobot(busAxis(kBusDamiao, "joint", 1) + busAxis(kBusDamiao, "other", 2) +
                                busAxis(kBusDamiao, "renamed", 9))));
  scene.robot().start();
  scene.drive("renamed").powerOff(scene.now());  // it is not there, but expected
  ASSERT_TRUE(scene.runUntil([&] { return scene.node("joint").ready(); }, kFamilyBoot));
  EXPECT_FALSE(scene.node("renamed").ready());
  scene.run(500ms);
  ASSERT_TRUE(setFamilyBus(scene, 9, 0, true).success) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::save_parameters, "joint").success) << scene.told();
  (void)scene.ask(bus::NmtServiceCommand{"joint", "reset_node"});
  EXPECT_TRUE(scene.runUntil([&] { return scene.node("renamed").ready(); }, kFamilyBoot))
      << scene.told();
  EXPECT_TRUE(scene.node("other").ready());
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "renamed").success) << scene.told();
  EXPECT_TRUE(scene.truth("joint").power_stage_on) << "the motor that is at node 9 by now";
  EXPECT_FALSE(scene.truth("other").power_stage_on);
}

}  // namespace
}  // namespace cia402
