// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives that cry without end: nothing else is lost, and every cry is counted.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

/// Sends emergencies with this code from the drive's own controller.
void cry(Scene& scene, const std::string& axis, std::uint16_t code) {
  const auto node = scene.node(axis).id();
  const bool taken = scene.port(axis).send(
      can::Frame(0x080U + node, {static_cast<std::uint8_t>(code & 0xFF),
                                 static_cast<std::uint8_t>(code >> 8), 0x10, 1, 2, 3, 4, 5}));
  ASSERT_TRUE(taken);
}

std::uint64_t lines(const Scene& scene, const std::string& words) {
  const std::string text = scene.told();
  std::uint64_t count = 0;
  for (auto at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++count;
  return count;
}

TEST(EmergencyStorm, OfAThousandASecondCostsALineEveryFiveSeconds) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  scene.run(1s);
  const std::size_t told_before = scene.robot().events().size();
  for (int i = 0; i < 20'000; ++i) {
    cry(scene, "left", 0x8250);
    scene.run(1ms);
  }
  scene.run(6s);
  EXPECT_EQ(scene.robot().emergencies().size(), 20'000u) << "each is published";
  EXPECT_LE(scene.robot().events().size() - told_before, 10u) << scene.told();
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): emergency 0x8250 "));
  EXPECT_THAT(scene.told(), HasSubstr("20,000 times since start"));
  bus::NetworkSnapshot snapshot;
  scene.robot().network().fill(snapshot);
  EXPECT_EQ(snapshot.axes[scene.index("left")].emergencies.total, 20'000u);
  EXPECT_EQ(snapshot.axes[scene.index("right")].emergencies.total, 0u);
}

TEST(EmergencyStorm, OfAllNodesAtOnceLeavesOtherNewsAndMotionAlone) {
  std::string yaml =
      "bus: {interface: sim, bitrate: 1000000, sync_period: 0.01, heartbeat: 0.1}\n"
      "defaults: {drive: generic_cia402, counts_per_turn: 131072, mode: cyclic_position,\n"
      "  limits: {lower: -2.5, upper: 2.5, velocity: 1.5, acceleration: 4.0}}\naxes:\n";
  std::vector<std::string> names;
  for (int node = 1; node <= 8; ++node) {
    names.push_back("axis" + std::to_string(node));
    yaml += "  " + names.back() + ": {node_id: " + std::to_string(node) + "}\n";
  }
  yaml += "groups: {pair: {joints: [axis1, axis2]}}\n";
  Scene scene(loadText(yaml));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "axis1").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "axis2").success);
  ASSERT_TRUE(scene.move({1.0, -1.0}, 4s).success);
  for (int i = 0; i < 3000; ++i) {  // an error and its reset in turn: the worst for the log
    for (const std::string& name : names) cry(scene, name, i % 2 == 0 ? 0x8110 : 0x0000);
    scene.run(2ms);
  }
  scene.run(1s);
  EXPECT_NEAR(scene.position("axis1"), 1.0, 1e-3);
  EXPECT_NEAR(scene.position("axis2"), -1.0, 1e-3);
  EXPECT_EQ(lines(scene, "pair: "), 1u) << "the end of the trajectory is told";
  scene.robot().network().beginShutdown(scene.now());
  ASSERT_TRUE(scene.runUntil([&] { return scene.robot().network().shutDown(); }, 3s));
  EXPECT_EQ(scene.robot().emergencies().size(), 8u * 3000u);
  EXPECT_EQ(lines(scene, "emergency 0x8110 CAN overrun (objects lost): came"), 8u * 2u);
  EXPECT_EQ(lines(scene, "1,500 times since start"), 8u * 2u) << "of both codes of each axis";
  EXPECT_LT(scene.robot().events().size(), 8u * 25u);
  bus::NetworkSnapshot snapshot;
  scene.robot().network().fill(snapshot);
  for (const bus::AxisSnapshot& axis : snapshot.axes) {
    EXPECT_EQ(axis.emergencies.total, 3000u);
    ASSERT_EQ(axis.emergencies.codes, 2u);
    EXPECT_EQ(axis.emergencies.of[0].count, 1500u);
    EXPECT_EQ(axis.emergencies.of[1].count, 1500u);
  }
}

TEST(EmergencyFrames, OfWrongLengthAreToldAndCounted) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  scene.port("left").send(can::Frame(0x081, {0x11, 0x86, 0x01}));
  scene.port("left").send(can::Frame(0x081, {0x11}));
  scene.port("right").send(can::Frame(0x082, {}));
  scene.run(10ms);
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): emergency: 0x8611 following error"));
  EXPECT_THAT(scene.told(), HasSubstr("the frame has 3 bytes instead of 8"));
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): an emergency frame of 1 byte has no error"));
  EXPECT_THAT(scene.told(),
              HasSubstr("right (node 2): an emergency frame of 0 bytes has no error code"));
}

}  // namespace
}  // namespace cia402
