// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives that reboot, vanish, come late or are not what was configured; and a master that dies.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::HasSubstr;

constexpr const char* kHome = ", homing: {method: 37, offset: 0.0}";

/// Both axes homed, enabled, the right one on its way in a group of its own.
class Nodes : public testing::Test {
 protected:
  Nodes() : scene(loadText(genericPair(kHome) + "  alone: {joints: [right]}\n")) {}
  void begin() {
    ASSERT_TRUE(scene.boot());
    ASSERT_TRUE(scene.procedure(ProcedureKind::home, "left").success);
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
    ASSERT_TRUE(scene.move({2.0}, 6s, 1).success);
    scene.run(500ms);
    scene.watch([this] {
      const double off = std::abs(scene.axis("right").target() - scene.position("right"));
      worst = std::isnan(off) ? 9.0 : std::max(worst, off);
    });
  }
  void expectRightArrived() {
    scene.run(8s);
    EXPECT_NEAR(scene.position("right"), 2.0, 1e-3);
    EXPECT_LT(worst, 0.02) << "the other axis noticed";
  }
  Scene scene;
  double worst = 0.0;
};

TEST_F(Nodes, ARebootedDriveIsConfiguredAgainAndLeftDisabled) {
  begin();
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health != Health::ready; }, 2s));
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 6s)) << scene.told();
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_FALSE(scene.state("left").homed) << "an incremental encoder lost its zero";
  EXPECT_EQ(scene.truth("left").nmt, canopen::NmtState::operational);
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1)"));
  EXPECT_THAT(scene.setpoint("left", 0.1), HasSubstr("left"));
  EXPECT_EQ(scene.drive("left").dictionary().find({0x6081, 0})->number, 3129114u)
      << "1.5 rad/s * 100 turns * 131072 / 2 pi";
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_FALSE(recovered.success) << "it takes no position";
  EXPECT_THAT(recovered.message, HasSubstr("left is not homed: home"));
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  EXPECT_THAT(scene.setpoint("left", 0.1), HasSubstr("not homed"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "left").success);
  EXPECT_EQ(scene.setpoint("left", 0.1), "");
  expectRightArrived();
}

TEST_F(Nodes, APulledCableLosesTheNodeAndTheDriveStopsByItself) {
  begin();
  ASSERT_EQ(scene.setpoint("left", 2.0), "");
  scene.run(700ms);
  ASSERT_GT(scene.velocity("left"), 0.5);
  scene.port("left").setAttached(false);
  ASSERT_TRUE(scene.runUntil([&] { return !scene.truth("left").power_stage_on; }, 1500ms));
  EXPECT_FALSE(scene.truth("left").moving);
  EXPECT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::lost; }, 100ms))
      << "within a period of the drive, which began to watch at another moment";
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): no heartbeat for 0.3 s: check power and "
                                      "cable"));
  EXPECT_FALSE(scene.state("left").feedback_valid);
  EXPECT_TRUE(std::isnan(scene.state("left").position)) << "never an invented position";
  scene.run(1s);
  scene.port("left").setAttached(true);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 6s)) << scene.told();
  scene.forget();
  scene.run(1s);
  EXPECT_FALSE(scene.truth("left").power_stage_on) << "back, but nobody asked to enable it";
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_THAT(recovered.message, HasSubstr("left is not homed: home"));
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  scene.run(500ms);
  EXPECT_LT(scene.seen("left").travel(), 1e-3) << "not on to the old set-point";
  expectRightArrived();
}

TEST_F(Nodes, ADriveThatFallsSilentIsLostAndTheOthersGoOn) {
  begin();
  scene.inject("left", "silent");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::lost; }, 1s));
  const auto refused = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("cannot enable: the node is lost"));
  expectRightArrived();
}

TEST(Boot, AnSdoSilentNodeFailsInWordsAndTheOtherWorks) {
  Scene scene(loadText(genericPair()));
  scene.robot().start();
  scene.inject("left", "sdo_silent");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("right").health == Health::ready; }, 3s));
  scene.run(12s);
  EXPECT_NE(scene.state("left").health, Health::ready);
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1)"));
  EXPECT_THAT(scene.told(), HasSubstr("does not answer"));
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  scene.inject("left", "clear");
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(recovered.success) << recovered.message;
}

TEST(Boot, AnAbsentNodeIsToldAndTakenInOncePoweredOn) {
  Scene scene(loadText(genericPair()));
  scene.robot().start();
  scene.drive("left").powerOff(scene.now());
  scene.port("left").setPowered(false);
  scene.run(8s);
  EXPECT_EQ(scene.state("left").health, Health::absent);
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): does not answer: neither a boot-up message"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
  scene.port("left").setPowered(true);
  scene.drive("left").powerOn(scene.now());
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 6s)) << scene.told();
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  EXPECT_TRUE(scene.truth("left").power_stage_on && scene.truth("right").power_stage_on);
}

TEST(Boot, SwappedDrivesAreRefusedWhileTheRestWorks) {
  LoadedRobot loaded = loadText(genericPair("", "") + "");
  for (auto& node : loaded.master.nodes) {
    if (node.name == "left") node.serial = 4711;
  }
  Scene scene(std::move(loaded));
  scene.robot().start();
  scene.run(6s);
  EXPECT_EQ(scene.state("left").health, Health::failed);
  EXPECT_THAT(scene.told(), HasSubstr("is another drive than configured: 1018:04"));
  EXPECT_THAT(scene.told(), HasSubstr("check node-ID and wiring"));
  EXPECT_NE(scene.truth("left").nmt, canopen::NmtState::operational);
  EXPECT_FALSE(scene.procedure(ProcedureKind::enable, "left").success);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
}

TEST(Boot, AWrongDeviceTypeIsRefusedInWords) {
  LoadedRobot loaded = loadText(genericPair());
  const auto damiao = loadText(damiaoJoint());
  loaded.drives[0].definition = damiao.drives[0].definition;
  loaded.master.nodes[0].device_type = 0x00020192;
  Scene scene(std::move(loaded));
  scene.robot().start();
  scene.run(6s);
  EXPECT_EQ(scene.state("left").health, Health::failed);
  EXPECT_THAT(scene.told(),
              HasSubstr("1000:00 device type is 0x00030000, configured is 0x00020192"));
  EXPECT_EQ(scene.state("right").health, Health::ready);
}

TEST(Boot, AnObjectThatTheDriveLacksIsNamed) {
  Scene scene(loadText(
      genericPair(", pdos: {rpdo1: [controlword, target_position], rpdo2: [target_velocity], "
                  "tpdo1: [statusword, position_actual, mode_display], tpdo2: [velocity_actual, "
                  "dc_link_voltage]}")));
  scene.robot().start();
  scene.run(6s);
  EXPECT_EQ(scene.state("left").health, Health::failed);
  EXPECT_THAT(scene.told(), HasSubstr("one of these cannot be mapped: "));
  EXPECT_THAT(scene.told(), HasSubstr("6079:00"));
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1)"));
  EXPECT_EQ(scene.state("right").health, Health::ready);
}

TEST(Boot, ADriveLeftEnabledByADeadDriverDoesNotMoveAndIsDisabled) {
  Scene scene(loadText(genericPair(", simulation: {initial_position: 1.0}")));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.forget();
  drive::Axis& axis = scene.axis("left");
  axis.device().boot(scene.now(), false);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 6s));
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_LT(scene.seen("left").travel(), 1e-3);
}

TEST(Boot, ADriveThatLocksItsParametersWhileEnabledComesBackAfterAPulledCable) {
  Scene scene(loadText(damiaoJoint()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.forget();
  scene.robot().port().setAttached(false);  // the driver's end of the cable
  scene.run(1s);
  ASSERT_NE(scene.state("joint").health, Health::ready);
  scene.robot().port().setAttached(true);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("joint").power_stage_on) << "nobody asked it to come back";
  EXPECT_LT(scene.seen("joint").travel(), 1e-3);
  const auto recovered = scene.procedure(ProcedureKind::recover, "joint");
  EXPECT_TRUE(recovered.success) << recovered.message;
}

TEST(Master, WhenItDiesTheDrivesStopByThemselves) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({2.0, -2.0}, 4s).success);
  scene.run(2s);
  ASSERT_GT(scene.velocity("left"), 0.5);
  scene.robot().port().setPowered(false);
  scene.run(300ms + 100ms);  // heartbeat time-out and quick-stop ramp: 0.75 rad/s at 8 rad/s^2
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-2);
  EXPECT_NEAR(scene.velocity("right"), 0.0, 1e-2);
  scene.run(300ms);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_FALSE(scene.truth("right").power_stage_on);
}

TEST(Sync, WithACounterUpsetsNoDriveAndCountsPast240) {
  Scene scene(loadFile("arm.yaml"));
  unsigned highest = 0, lowest = 999, last = 0;
  bool orderly = true;
  std::vector<std::uint16_t> emergencies;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id > 0x80 && frame.id < 0x100 && frame.size >= 2) {
      emergencies.push_back(static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8));
    }
    if (frame.id != 0x80) return;
    ASSERT_EQ(frame.size, 1);
    const unsigned count = frame.data[0];
    if (last != 0) orderly = orderly && count == last % 240 + 1;
    last = count;
    highest = std::max(highest, count);
    lowest = std::min(lowest, count);
  });
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(5s);
  EXPECT_EQ(highest, 240u);
  EXPECT_EQ(lowest, 1u);
  EXPECT_TRUE(orderly);
  EXPECT_THAT(emergencies, testing::Each(0)) << "0x8240: a SYNC of unexpected length";
}

}  // namespace
}  // namespace cia402
