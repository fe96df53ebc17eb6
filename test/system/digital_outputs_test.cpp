// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// set_digital_outputs of whole robots: the terminals of the simulated drives say what came of it.
#include "bus/jobs/output_job.h"
#include "system/families_scene.h"

namespace cia402 {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

bus::Answer setOutputs(Scene& scene, const std::string& axis, const std::vector<std::string>& names,
                       const std::vector<bool>& values) {
  return scene.call(bus::SetOutputsCommand{axis, names, values});
}

TEST(DigitalOutputs, ShowAtTheTerminalsWhileTheAxisMoves) {
  ReadyScene scene(genericPair());
  ASSERT_EQ(scene.setpoint("left", 0.5), "");
  scene.run(100ms);
  const auto set = setOutputs(scene, "left", {"do1", "do3"}, {true, true});
  EXPECT_TRUE(set.success) << set.message;
  EXPECT_EQ(set.message, "left (node 1): do1 on, do3 on");
  EXPECT_EQ(scene.truth("left").outputs, 0x00050000U);
  EXPECT_EQ(scene.truth("right").outputs, 0U);
  EXPECT_TRUE(setOutputs(scene, "left", {"do1"}, {false}).success);
  EXPECT_EQ(scene.truth("left").outputs, 0x00040000U) << "do3 stays";
  scene.run(3s);
  EXPECT_NEAR(scene.position("left"), 0.5, 1e-3) << scene.told();
}

// A stale 1 of 60FEh:01 behind a closed mask.
TEST(DigitalOutputs, ShowNoOlderValueForAMoment) {
  ReadyScene scene(genericPair());
  ASSERT_TRUE(scene.call(bus::WriteObjectCommand{"left", "digital_outputs", "0x10000"}).success);
  std::uint32_t shown = 0;
  scene.world().bus().setMonitor(
      [&](const can::Frame&, Time) { shown |= scene.truth("left").outputs; });
  EXPECT_TRUE(setOutputs(scene, "left", {"do1"}, {false}).success);
  EXPECT_EQ(shown, 0U);
}

TEST(DigitalOutputs, OfAnAxisInASharedDriveAreItsOwn) {
  Scene scene(
      loadText("bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
               "defaults: {drive: generic_cia402, counts_per_turn: 131072, gear_ratio: 100.0,\n"
               "  limits: {lower: -2.5, upper: 2.5, velocity: 1.5, acceleration: 4.0}}\n"
               "axes:\n"
               "  left: {node_id: 1, simulation: {drive: generic_cia402_dual}}\n"
               "  right: {node_id: 1, device_axis: 1}\n"));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_TRUE(setOutputs(scene, "right", {"do2"}, {true}).success);
  EXPECT_EQ(scene.truth("left").outputs, 0U);
  EXPECT_EQ(scene.truth("right").outputs, 0x00020000U);
}

TEST(DigitalOutputs, WorkByEachProfileThatHasThem) {
  struct Row {
    const char *drive, *counts, *output;
    std::uint32_t shown;
  };
  for (const Row& row : {Row{"sv660c", "100000", "do2", 0x00020000},
                         Row{"megmeet_dm5", "8388608", "do2", 0x00020000},
                         Row{"nimotion_stepper", "10000", "do1", 0x00000002}}) {
    const bool inovance = row.drive == std::string("sv660c");
    const bool megmeet = row.drive == std::string("megmeet_dm5");
    std::string yaml = familyJoint({row.drive, row.counts, "profile_position"},
                                   megmeet ? ", write: [{object: do2_function, raw: 28}]" : "");
    const std::string gear = "raw: 3125}";  // it writes already
    if (inovance) yaml.insert(yaml.find(gear) + gear.size(), ", {object: do2_function, raw: 31}");
    Scene scene(loadText(yaml));
    ASSERT_TRUE(scene.boot()) << row.drive << scene.told();
    const auto set = setOutputs(scene, "joint", {row.output}, {true});
    EXPECT_TRUE(set.success) << row.drive << ": " << set.message;
    EXPECT_EQ(scene.truth("joint").outputs, row.shown) << row.drive;
  }
}

TEST(DigitalOutputs, OfADriveWithoutThemAreRefusedInWords) {
  Scene scene(loadText(genericPair(", simulation: {drive: generic_cia402_minimal}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto refused = setOutputs(scene, "left", {"do1"}, {true});
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(
      refused.message,
      HasSubstr("left (node 1): outputs not set: 60FE:02 digital_outputs_mask not read: the "
                "drive refused: 0x06020000"));
}

TEST(DigitalOutputs, AreRefusedWhileTheDriveIsAway) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.inject("left", "silent");
  scene.run(1s);
  const auto refused = setOutputs(scene, "left", {"do1"}, {true});
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("left"));
}

}  // namespace
}  // namespace cia402
