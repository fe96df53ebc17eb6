// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The SV660C on other buses, after a restart, and what is read and written of it by name.
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

void expectSv660cMoves(Scene& scene, double goal) {
  ASSERT_EQ(scene.setpoint("joint", goal), "");
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), goal, 1e-5) << scene.told();
}

// H0C.08 [L9277-9307].
TEST(Sv660cBus, RunsAtEachRateThatCarriesItsCycle) {
  for (const char* rate : {"1000000", "500000", "250000", "125000", "100000", "50000"}) {
    Scene scene(loadText(sv660cWith(sv660cJoint(", mode: ip", {}, "0.020", "[ip]"),
                                    "bitrate: 1000000", "bitrate: " + std::string(rate))));
    ASSERT_TRUE(scene.boot()) << rate << scene.told();
    const auto enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << rate << ": " << enabled.message;
    expectSv660cMoves(scene, 0.4);
  }
}

TEST(Sv660cBus, HasAnyNodeId) {
  for (const char* node : {"1", "64", "126"}) {
    Scene scene(loadText(sv660cWith(sv660cJoint(), "node_id: 1", "node_id: " + std::string(node))));
    ASSERT_TRUE(scene.boot()) << node << scene.told();
    EXPECT_EQ(sv660cNumber(scene, 0x200C, 1), std::stoul(node));
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    expectSv660cMoves(scene, 0.4);
  }
}

TEST(Sv660cBus, IsGuardedWhereThatIsAskedFor) {
  Scene scene(loadText(sv660cJoint(", error_control: guarding")));
  unsigned requests = 0;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id == 0x701 && frame.remote) ++requests;
  });
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(2s);
  EXPECT_GT(requests, 15U);
  EXPECT_NE(sv660cNumber(scene, 0x100C), 0U);
  EXPECT_GT(sv660cNumber(scene, 0x100D), 1U) << "[L13337]";
  EXPECT_EQ(sv660cNumber(scene, 0x1017), 0U);
  EXPECT_EQ(scene.state("joint").health, fieldbus::Health::ready);
}

/// The settings that the driver counts on, after it has booted the drive.
std::vector<std::uint64_t> sv660cSettings(Scene& scene) {
  constexpr fieldbus::ObjectId kCounted[] = {
      {0x605A, 0}, {0x605C, 0}, {0x605D, 0}, {0x605E, 0}, {0x6065, 0}, {0x607F, 0},
      {0x6081, 0}, {0x6083, 0}, {0x6084, 0}, {0x6085, 0}, {0x1017, 0}, {0x6091, 1},
      {0x6091, 2}, {0x6099, 1}, {0x6099, 2}, {0x60C2, 1}, {0x60C2, 2}, {0x200C, 0x0E}};
  std::vector<std::uint64_t> found;
  for (const fieldbus::ObjectId id : kCounted) {
    found.push_back(sv660cNumber(scene, id.index, id.subindex));
  }
  return found;
}

TEST(Sv660cRestart, LeavesItDisabledWithAllItsSettingsWritten) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto before = sv660cSettings(scene);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  expectSv660cMoves(scene, 0.8);
  scene.inject("joint", "power_cycle");
  scene.run(50ms);
  scene.forget();
  scene.run(3s);
  EXPECT_EQ(sv660cSettings(scene), before);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  const auto recovered = scene.procedure(ProcedureKind::recover, "joint");
  ASSERT_TRUE(recovered.success) << recovered.message << scene.told();
  scene.run(500ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4) << "its incremental encoder begins at 0";
}

// H0d.00 = 1 [L9428]: the way to let parameters count that want power off and on.
TEST(Sv660cRestart, IsMadeByItsSoftwareReset) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto before = sv660cSettings(scene);
  const std::uint32_t boot_ups = scene.node("joint").bootUps();
  const auto written = scene.call(bus::WriteObjectCommand{"joint", "software_reset", "1"});
  EXPECT_TRUE(written.success) << written.message;
  scene.run(3s);
  EXPECT_EQ(scene.node("joint").bootUps(), boot_ups + 1);
  EXPECT_EQ(sv660cSettings(scene), before);
  ASSERT_TRUE(scene.procedure(ProcedureKind::recover, "joint").success) << scene.told();
  const auto refused = scene.call(bus::WriteObjectCommand{"joint", "software_reset", "1"});
  EXPECT_FALSE(refused.success) << "while stopped only";
  EXPECT_THAT(refused.message, HasSubstr("0x08000022"));
}

// 2.5 rad * 50 turns * 100000 units / 2 pi = 1989437 units; 200A:29 = 2: once home was found.
TEST(Sv660cLimits, AreThoseOfTheJointOnceItIsHomed) {
  Scene scene(
      loadText(sv660cJoint(", homing: {method: 35, offset: 0.5}", "initial_position: 1.1")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_EQ(sv660cNumber(scene, 0x200A, 0x29), 2U);
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  scene.run(200ms);
  EXPECT_EQ(sv660cNumber(scene, 0x607D, 1), 0xFFFFFFFFU - 1989437U + 1U);
  EXPECT_EQ(sv660cNumber(scene, 0x607D, 2), 1989437U);
  EXPECT_EQ(sv660cNumber(scene, 0x607C), 397887U) << "0.5 rad";
  ASSERT_EQ(scene.setpoint("joint", 2.6), "");
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), 1.1 + 2.5 - 0.5, 1e-5) << "0.5 was at 1.1";
}

// The factory's numbers are for 1:1: at 6091h of the axis they would be 84 times as fast.
TEST(Sv660cLimits, OfTheFactoryAreNotKept) {
  Scene scene(loadText(sv660cWith(sv660cJoint(),
                                  "velocity: 1.5, acceleration: 4.0,\n"
                                  "             effort: 100.0",
                                  "velocity: 1.5")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  constexpr double kRad = 6.283185307179586 / 5e6;  // a user unit
  EXPECT_NEAR(static_cast<double>(sv660cNumber(scene, 0x6081)) * kRad, 1.5, 1e-5);
  EXPECT_NEAR(static_cast<double>(sv660cNumber(scene, 0x607F)) * kRad, 1.65, 1e-5);
  EXPECT_NEAR(static_cast<double>(sv660cNumber(scene, 0x6083)) * kRad, 1.0, 1e-5);
  EXPECT_NEAR(static_cast<double>(sv660cNumber(scene, 0x6084)) * kRad, 1.0, 1e-5);
  EXPECT_NEAR(static_cast<double>(sv660cNumber(scene, 0x6065)) * kRad, 0.1, 1e-5);
  EXPECT_NEAR(static_cast<double>(sv660cNumber(scene, 0x6099, 1)) * kRad, 0.05, 1e-5);
  EXPECT_NEAR(static_cast<double>(sv660cNumber(scene, 0x6099, 2)) * kRad, 0.01, 1e-5);
}

TEST(Sv660cObjects, AreReadAndWrittenByNameAlsoWhileItRuns) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  for (const auto& [name, value] :
       {std::pair("speed_gain", "250"), std::pair("positive_torque_limit", "1500"),
        std::pair("touch_probe_function", "0x0013"), std::pair("position_window", "100")}) {
    const auto written = scene.call(bus::WriteObjectCommand{"joint", name, value});
    EXPECT_TRUE(written.success) << written.message;
  }
  EXPECT_EQ(sv660cNumber(scene, 0x2008, 1), 250U);
  EXPECT_EQ(sv660cNumber(scene, 0x60E0), 1500U);
  EXPECT_EQ(sv660cNumber(scene, 0x60B8), 0x13U);
  const auto beyond = scene.call(bus::WriteObjectCommand{"joint", "positive_torque_limit", "4001"});
  EXPECT_FALSE(beyond.success);
  EXPECT_THAT(beyond.message, HasSubstr("0 to 4000"));
  const auto stopped = scene.call(bus::WriteObjectCommand{"joint", "quick_stop_option", "2"});
  EXPECT_FALSE(stopped.success);
  for (const char* name : {"nmt_length_errors", "alarm_code", "dc_link_voltage", "encoder_turns"}) {
    const auto read = scene.call(bus::ReadObjectCommand{"joint", name});
    EXPECT_TRUE(read.success) << read.message;
  }
}

// 60FDh is not known to be mappable: it is asked for.
TEST(Sv660cObjects, TellTheSwitches) {
  Scene scene(loadText(sv660cJoint(
      {}, "initial_position: 0.0, home_switch: [-0.1, 0.1], upper_limit_switch: -0.5")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto read = scene.call(bus::ReadObjectCommand{"joint", "digital_inputs"});
  EXPECT_TRUE(read.success);
  EXPECT_THAT(read.message,
              HasSubstr(" 8454150 (0x00810006): di1, di8, forward limit, home switch"))
      << "bits 1 and 2, and those of their terminals, 16 and 23 [L16153]";
}

}  // namespace
}  // namespace cia402
