// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive that homes by itself is lost by its heartbeat alone, on a bus that loses frames: the
// motor stops all the same, soon, and stays where it is.
#include "sim/definition/drive_definition.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using fieldbus::Health;

constexpr Duration kHeartbeatTimeout = 300ms;
constexpr Duration kRepeats = 100ms;  // in which the commands to stop come again and again
constexpr Duration kRamp = 100ms;     // 0.3 rad/s by the drive's quick stop, and the look at it

struct Lost {
  const char* name;
  bool stops_by_nmt;  ///< the motor stops when the drive leaves operational
  double loss;        ///< of each frame at each receiver
  friend std::ostream& operator<<(std::ostream& out, const Lost& lost) { return out << lost.name; }
};

class LostDrive : public testing::TestWithParam<Lost> {
 protected:
  static LoadedRobot load() {
    LoadedRobot loaded = loadText(genericPair(
        ", simulation: {lower_limit_switch: -2.4}, homing: {method: 17, offset: 0.0, "
        "search_velocity: 0.3, zero_velocity: 0.05, acceleration: 2.0, timeout: 30.0}"));
    sim::DriveDefinition definition = *loaded.drives[0].definition;
    definition.stops_outside_operational = GetParam().stops_by_nmt;
    loaded.drives[0].definition =
        std::make_shared<const sim::DriveDefinition>(std::move(definition));
    return loaded;
  }
  /// Homes, and hears no more of the drive: its heartbeats get lost, and then other frames, too.
  void lose(Scene& scene) {
    ASSERT_TRUE(scene.boot()) << scene.told();
    if (!GetParam().stops_by_nmt) {
      ASSERT_TRUE(call(scene, bus::WriteObjectCommand{"left", "6007:00", "0"}).success);
    }
    (void)scene.begin(ProcedureKind::home, "left");
    ASSERT_TRUE(scene.runUntil([&] { return std::abs(scene.velocity("left")) > 0.25; }, 3s));
    sim::FaultRule heartbeats;
    heartbeats.id = 0x701;
    heartbeats.count = 6;
    scene.world().bus().faults().add(heartbeats);
    const canopen::Node& node = scene.node("left");
    while (scene.now() < node.lastHeartbeat() + kHeartbeatTimeout - 1ms) scene.run(1ms);
    sim::FaultRates rates;
    rates.loss = GetParam().loss;
    scene.world().bus().faults().setRates(rates);
  }
};

TEST_P(LostDrive, ThatHomesStopsWithinTheTimeOutAndAFewRepetitions) {
  unsigned moving = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Scene scene(load(), seed);
    ASSERT_NO_FATAL_FAILURE(lose(scene));
    const Time heard = scene.node("left").lastHeartbeat();
    moving += std::abs(scene.velocity("left")) > 0.25 ? 1U : 0U;
    while (scene.now() < heard + kHeartbeatTimeout + kRepeats + kRamp) scene.run(1ms);
    EXPECT_LT(std::abs(scene.velocity("left")), 0.01) << "seed " << seed;
    scene.forget();
    scene.run(3s);
    EXPECT_LT(scene.seen("left").travel(), 0.01) << "seed " << seed;
  }
  EXPECT_GE(moving, 30U) << "of 40 that were lost in motion";
}

INSTANTIATE_TEST_SUITE_P(Of, LostDrive,
                         testing::Values(Lost{"a_good_bus", true, 0.0},
                                         Lost{"a_lossy_bus", true, 0.23},
                                         Lost{"a_drive_deaf_to_nmt_stop", false, 0.0},
                                         Lost{"that_on_a_lossy_bus", false, 0.23}),
                         [](const auto& tested) { return std::string(tested.param.name); });

/// It has no heartbeat any more, and the stop that it is told as a lost drive takes SDO from it.
TEST(RebootedDrive, ThatNobodyHeardRebootIsFoundAgain) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.drive("left").device().behaviour().boot_up_message = false;
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::lost; }, 1s));
  ASSERT_TRUE(scene.runUntil(
      [&] { return scene.drive("left").device().nmtState() == canopen::NmtState::stopped; }, 3s));
  EXPECT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 4s)) << scene.told();
}

/// Nothing of the drive is heard since its motor stood, and it is not missed yet.
TEST(OverdueDrive, IsBrakedBeforeItIsDisabled) {
  Scene scene(loadText(
      genericPair(", simulation: {lower_limit_switch: -2.4}, homing: {method: 17, offset: 0.0, "
                  "search_velocity: 1.0, zero_velocity: 0.05, acceleration: 4.0, timeout: 30.0}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  unsigned controlword = 0;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id == 0x201) controlword = frame.data[0] | frame.data[1] << 8;
  });
  (void)scene.begin(ProcedureKind::home, "left");
  ASSERT_TRUE(scene.runUntil([&] { return (controlword & 0x0010) != 0; }, 3s));
  sim::FaultRule all;
  all.id = 1;
  all.mask = 0x7F;
  all.count = 1000;
  all.receiver = "master";
  scene.world().bus().faults().add(all);
  ASSERT_TRUE(scene.runUntil([&] { return std::abs(scene.velocity("left")) > 0.05; }, 40ms));
  ASSERT_TRUE(scene.state("left").feedback_valid);
  (void)scene.begin(ProcedureKind::disable, "left");
  scene.run(10ms);
  ASSERT_GT(std::abs(scene.velocity("left")), 0.02);
  EXPECT_EQ(controlword & 0x0087, 0x0002u) << "quick stop";
}

}  // namespace
}  // namespace cia402
