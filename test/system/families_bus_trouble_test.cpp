// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The families' drives on a bus that fails, with SYNC of their own, and when the driver ends.
#include "system/families_bus_scene.h"
#include "system/interface_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using canopen::NmtState;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class FamilyTrouble : public testing::TestWithParam<FamilyMode> {
 protected:
  /// On its way, and far from there.
  static void setOff(Scene& scene) {
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
    ASSERT_EQ(scene.setpoint("joint", scene.state("joint").position + 2.0), "");
    scene.run(1s);
    ASSERT_GT(scene.velocity("joint"), 0.5);
  }
};

INSTANTIATE_TEST_SUITE_P(All, FamilyTrouble, allFamilies(), nameOfFamily);

TEST_P(FamilyTrouble, AtTheEndOfTheDriverLeavesTheMotorStoppedAndOff) {
  Scene scene(loadText(busJoint(GetParam())));
  ASSERT_NO_FATAL_FAILURE(setOff(scene));
  scene.robot().network().beginShutdown(scene.now());
  ASSERT_TRUE(scene.runUntil([&] { return scene.robot().network().shutDown(); }, 2s));
  scene.run(100ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

TEST_P(FamilyTrouble, OfAPulledCableEndsDisabledUntilSomebodyAsks) {
  Scene scene(loadText(busJoint(GetParam())));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  scene.port("joint").setAttached(false);
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("joint").health == Health::lost; }, 1s));
  scene.run(1s);
  scene.port("joint").setAttached(true);
  scene.forget();
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 60s)) << scene.told();
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4);
  const bus::Answer recovered = scene.procedure(ProcedureKind::recover, "joint");
  EXPECT_TRUE(recovered.success) << recovered.message;
  expectGoes(scene, 0.3);
}

TEST(FamilyBusOff, LeavesADamiaoDisabledUntilSomebodyAsks) {
  InterfaceScene scene(loadText(busJoint(kBusDamiao)), {});
  ASSERT_TRUE(scene.runUntil([&] { return scene.allReady(); }, 8s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({1.5}, 4s).success);
  scene.run(2s);
  ASSERT_TRUE(scene.truth(0).moving);
  scene.port().forceBusOff();
  ASSERT_TRUE(scene.runUntil(
      [&] { return scene.interface().state() == can::BusState::error_active; }, 20s));
  ASSERT_TRUE(scene.runUntil([&] { return scene.allReady(); }, 8s)) << scene.told();
  scene.run(2s);
  EXPECT_FALSE(scene.truth(0).moving);
  EXPECT_FALSE(scene.truth(0).power_stage_on);
  const auto recovered = scene.procedure(ProcedureKind::recover);
  EXPECT_TRUE(recovered.success) << recovered.message;
}

// Whether it enters operational by itself is not printed [L1020]; it is configured either way.
TEST(Id286Start, ByItselfIsFoundByItsHeartbeatAndConfigured) {
  TracedScene scene(busJoint(kBusId286,
                             ", simulation: {with: {communication: "
                             "{starts_operational: true}}}"));
  scene.world().powerOn();
  scene.run(3s);
  ASSERT_EQ(scene.truth("joint").nmt, NmtState::operational);
  scene.robot().startDriver();
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, kFamilyBoot)) << scene.told();
  EXPECT_THAT(scene.writes(), Contains("2B 17 10 00 64 00 00 00"));
  EXPECT_THAT(scene.lines, Contains("000 01 01"));
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  expectGoes(scene, 0.3);
}

/// The drive makes SYNC: its period before its bit 30.
class FamilyProducer : public testing::TestWithParam<FamilyMode> {};

INSTANTIATE_TEST_SUITE_P(Of, FamilyProducer, testing::Values(kBusId286, kBusSv660c), nameOfFamily);

TEST_P(FamilyProducer, OfSyncIsFollowedAndIsTheOnlyOne) {
  BusOptions bus;
  bus.more = ", sync: external";
  const std::string gear =
      "write: [{object: gear_numerator, raw: 262144}, "
      "{object: gear_denominator, raw: 3125}";
  const std::string producer =
      "{object: \"1006:00\", type: uint32, raw: 4000}, "
      "{object: \"1005:00\", type: uint32, raw: 0x40000080}]";
  std::string axis = busAxis(GetParam());
  if (is(GetParam(), kBusSv660c)) {
    axis.replace(axis.find(gear + "]"), gear.size() + 1, gear + ", " + producer);
  } else {
    axis = busAxis(GetParam(), "joint", 1, ", write: [" + producer);
  }
  TracedScene scene(busRobot(axis, bus));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.run(1500ms);
  EXPECT_TRUE(inOrder(scene.writes(), {"23 06 10 00 A0 0F 00 00", "23 05 10 00 80 00 00 40"}));
  scene.clear();
  scene.run(1s);
  EXPECT_NEAR(static_cast<double>(scene.count("080")), 250.0, 1.0) << "of the drive alone";
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  expectGoes(scene, 0.3);
}

TEST_P(FamilyProducer, OfSyncIsStoppedWhereTheDriverProducesIt) {
  BusOptions bus;
  bus.more = ", listen: 0";
  TracedScene scene(busRobot(busAxis(GetParam()), bus));
  sim::ObjectDictionary& dictionary = scene.drive("joint").dictionary();
  dictionary.find({0x1006, 0})->initial_number = 4000;
  dictionary.find({0x1005, 0})->initial_number = 0x40000080;
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_EQ(numberIn(scene, 0x1005), 0x80U);
  scene.clear();
  scene.run(1s);
  EXPECT_NEAR(static_cast<double>(scene.count("080")), 250.0, 1.0);
}

// Further nodes may be given to it, each once [L13357-13443].
TEST(Sv660cConsumer, WatchesTheDriverAndWhomItIsToldOf) {
  std::string axis = busAxis(kBusSv660c);
  const std::string end = "{object: gear_denominator, raw: 3125}";
  axis.replace(axis.find(end), end.size(),
               end + ", {object: \"1016:02\", type: uint32, raw: 0x000501F4}");
  TracedScene scene(busRobot(axis));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_THAT(scene.writes(), Contains("23 16 10 01 2C 01 7F 00"));
  EXPECT_THAT(scene.writes(), Contains("23 16 10 02 F4 01 05 00"));
  EXPECT_EQ(numberIn(scene, 0x1016, 3) + numberIn(scene, 0x1016, 4) + numberIn(scene, 0x1016, 5),
            0U);
}

// The joints of a group move together or not at all.
TEST(FamilyGroup, IsStoppedWhereOneOfItIsLost) {
  for (const FamilyMode& tested : {kBusNimotion, kBusDm5, kBusSv660c, kBusDamiao}) {
    Scene scene(loadText(busRobot(busAxis(tested, "a", 1) + busAxis(tested, "b", 2)) +
                         "groups:\n  pair: {joints: [a, b]}\n"));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
    ASSERT_TRUE(scene.move({1.5, 1.5}, 6s).success);
    scene.run(2s);
    ASSERT_GT(scene.velocity("b"), 0.2);
    scene.port("a").setAttached(false);
    scene.run(1s);
    EXPECT_EQ(scene.state("a").health, Health::lost);
    EXPECT_NEAR(scene.velocity("b"), 0.0, 1e-3) << tested.family;
    EXPECT_EQ(scene.state("b").health, Health::ready);
  }
}

TEST(FamilyNodeIds, ThatAreGivenTwiceAreRefused) {
  for (const FamilyMode& tested : {kBusNimotion, kBusId286, kBusDm5, kBusSv660c, kBusDamiao}) {
    EXPECT_THAT(problemsOfRobot(busRobot(busAxis(tested, "a", 5) + busAxis(tested, "b", 5))),
                HasSubstr("node_id"));
    EXPECT_THAT(problemsOfRobot(busRobot(busAxis(tested, "a", 127))), HasSubstr("node_id"))
        << "that of the master";
  }
}

}  // namespace
}  // namespace cia402
