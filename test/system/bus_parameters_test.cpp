// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// set_bus_parameters: node-ID and bit rate of drives without LSS, by objects of their makers.
#include "bus/canopen/bus_setting_job.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

bus::Answer setBus(Scene& scene, unsigned node_id, unsigned bit_rate, bool confirm) {
  return scene.call(bus::SetBusParametersCommand{"joint", node_id, bit_rate, confirm});
}

TEST(BusParameters, AreNotWrittenUnlessThatIsConfirmed) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(500ms);
  const bus::Answer asked = setBus(scene, 5, 0, false);
  EXPECT_FALSE(asked.success);
  EXPECT_THAT(asked.message,
              AllOf(HasSubstr("joint (node 1): bus parameters not set: nothing was written: "
                              "node_id (200C:01) is 1 and would be 5 (node-ID 5)"),
                    HasSubstr("counts at once"), HasSubstr("change `node_id` of axes/joint"),
                    HasSubstr("confirm: true")));
  EXPECT_EQ(sv660cNumber(scene, 0x200C, 1), 1U);
  EXPECT_EQ(sv660cNumber(scene, 0x200C, 0x0E), 0U);
}

// H0C.13 is 1 while it is written, so that it stays [L9392].
TEST(BusParameters, AreWrittenIntoTheMemoryAndToldWithWhatMustFollow) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(500ms);
  std::vector<std::string> writes;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    const bool parameter = frame.data[1] == 0x0C && frame.data[2] == 0x20;
    if (frame.id != 0x601 || (frame.data[0] & 0xE0) != 0x20 || !parameter) return;
    writes.push_back(std::to_string(frame.data[3]) + "=" + std::to_string(frame.data[4]));
  });
  const bus::Answer node = setBus(scene, 5, 0, true);
  EXPECT_TRUE(node.success) << node.message;
  EXPECT_THAT(node.message,
              AllOf(HasSubstr("node-ID: node_id (200C:01) was 1 and is 5, which counts at once"),
                    HasSubstr("start the driver anew")));
  EXPECT_EQ(sv660cNumber(scene, 0x200C, 1), 5U);
  EXPECT_THAT(writes, testing::ElementsAre("14=1", "1=5", "14=0"));
  EXPECT_EQ(scene.drive("joint").device().node(), 5U);
  EXPECT_TRUE(scene.runUntil([&] { return !scene.node("joint").ready(); }, 2s)) << "it is lost";
}

TEST(BusParameters, OfTheBitRateTakeTheDriveFromItsBusAtOnce) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(500ms);
  const bus::Answer rate = setBus(scene, 0, 500000, true);
  EXPECT_TRUE(rate.success) << rate.message;
  EXPECT_THAT(rate.message,
              AllOf(HasSubstr("bit rate: bit_rate (200C:09) was 6 (1 Mbit/s, sample point 80 %) "
                              "and is 5 (500 kbit/s)"),
                    HasSubstr("counts at once"), HasSubstr("change `bitrate` of the bus")));
  EXPECT_TRUE(scene.runUntil([&] { return !scene.node("joint").ready(); }, 2s)) << "it is lost";
  scene.inject("joint", "power_cycle");
  scene.run(3s);
  EXPECT_FALSE(scene.node("joint").ready()) << "it stays at 500 kbit/s";
}

// Both speak at 1 Mbit/s [L9301-9307].
TEST(BusParameters, OfTheSamplePointLeaveTheDriveOnItsBus) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(500ms);
  for (const char* number : {"7", "6"}) {
    EXPECT_TRUE(sv660cWrite(scene, "H0C.08", number).success);
    scene.run(500ms);
    EXPECT_TRUE(scene.node("joint").ready()) << number;
    EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    EXPECT_TRUE(scene.procedure(ProcedureKind::disable).success) << scene.told();
  }
}

TEST(BusParameters, AreRefusedInWords) {
  Sv660cReady scene;
  EXPECT_THAT(setBus(scene, 5, 0, true).message, HasSubstr("the axis is not disabled"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  scene.run(500ms);
  EXPECT_THAT(setBus(scene, 128, 0, true).message, HasSubstr("a node-ID is 1 to 127"));
  EXPECT_THAT(setBus(scene, 0, 800000, true).message,
              HasSubstr("the drive has no bit rate 800000; it has 20000, 50000, 100000, 125000, "
                        "250000, 500000, 1000000 bit/s"));
  EXPECT_THAT(setBus(scene, 5, 500000, true).message, HasSubstr("one of them"));
  EXPECT_THAT(setBus(scene, 0, 0, true).message, HasSubstr("one of them"));
  EXPECT_EQ(sv660cNumber(scene, 0x200C, 1), 1U);
  EXPECT_EQ(sv660cNumber(scene, 0x200C, 9), 6U);
}

// Two drives would move by the commands of one.
TEST(BusParameters, AreNoNodeIdOfAnotherDriveOrOfTheMaster) {
  Scene scene(
      loadText(sv660cWith(sv660cJoint(), "axes:\n",
                          "axes:\n"
                          "  other: {node_id: 7, drive: generic_cia402, gear_ratio: 100.0,\n"
                          "    counts_per_turn: 131072, rated_torque: 0.64,\n"
                          "    limits: {lower: -2.5, upper: 2.5, velocity: 1.5,\n"
                          "             acceleration: 4.0, effort: 120.0}}\n")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(500ms);
  const bus::Answer taken = setBus(scene, 7, 0, true);
  EXPECT_FALSE(taken.success);
  EXPECT_THAT(taken.message, AllOf(HasSubstr("joint (node 1): bus parameters not set: node-ID 7 is "
                                             "that of other"),
                                   HasSubstr("give one a free node-ID first")));
  EXPECT_THAT(setBus(scene, 127, 0, true).message, HasSubstr("node-ID 127 is the master's own"));
  EXPECT_EQ(sv660cNumber(scene, 0x200C, 1), 1U);
  EXPECT_EQ(scene.drive("joint").device().node(), 1U);
  EXPECT_TRUE(setBus(scene, 1, 0, true).success) << "its own";
}

TEST(BusParameters, OfADriveWithoutSuchObjectsPointToLss) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(500ms);
  const bus::Answer refused = scene.call(bus::SetBusParametersCommand{"left", 5, 0, true});
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message,
              AllOf(HasSubstr("names no object that holds the node-ID"), HasSubstr("lss_assign")));
}

TEST(BusParameters, ThatTheDriveDoesNotTakeAreToldAsSuch) {
  Scene scene(
      loadText(sv660cJoint({}, sv660cDelivered("[0x200C, 9, bit_rate, uint16, ro, -, 5]"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(500ms);
  const bus::Answer refused = setBus(scene, 0, 250000, true);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("0x06010002"));
  EXPECT_EQ(sv660cNumber(scene, 0x200C, 0x0E), 0U) << "what was opened for it is closed again";
}

}  // namespace
}  // namespace cia402
