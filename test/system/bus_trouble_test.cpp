// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A disturbed bus, and an hour of everything at once.
#include <random>

#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using canopen::NodeHealth;
using drive::ProcedureKind;
using testing::HasSubstr;

struct Trouble {
  sim::FaultRates rates;
  std::uint64_t seed;
};

sim::FaultRates rates(double loss, double duplicate, double corrupt, double delay) {
  sim::FaultRates made;
  made.loss = loss;
  made.duplicate = duplicate;
  made.corrupt = corrupt;
  made.delay = delay;
  made.longest_delay = 3ms;
  return made;
}

class DisturbedBus : public testing::TestWithParam<Trouble> {};

TEST_P(DisturbedBus, BootsOrSaysWhyNotAndMovesWithinTheLimits) {
  Scene scene(loadText(genericPair()), GetParam().seed);
  scene.world().bus().faults().setRates(GetParam().rates);
  scene.robot().start();
  scene.runUntil([&] { return allReady(scene.robot()); }, 20s);
  for (drive::Axis& axis : scene.robot().robot().axes()) {
    if (axis.state().health == NodeHealth::ready) continue;
    if (axis.state().health == NodeHealth::booting) continue;
    EXPECT_NE(axis.node().problem(), "") << axis.config().name;
  }
  (void)scene.procedure(ProcedureKind::enable);
  (void)scene.move({2.0, -2.0}, 5s);
  scene.run(8s);
  for (const char* axis : {"left", "right"}) {
    EXPECT_LE(scene.seen(axis).highest, 2.5) << axis;
    EXPECT_GE(scene.seen(axis).lowest, -2.5) << axis;
    EXPECT_LE(scene.seen(axis).fastest, 110.0 / 100.0 * 6.2832) << axis << ": the motor's own";
  }
  scene.world().bus().faults().setRates({});
  for (const char* axis : {"left", "right"}) {
    const auto recovered = scene.procedure(ProcedureKind::recover, axis);
    EXPECT_TRUE(recovered.success) << recovered.message;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Rates, DisturbedBus,
    testing::Values(Trouble{rates(0.01, 0, 0, 0), 1}, Trouble{rates(0.01, 0.01, 0, 0), 2},
                    Trouble{rates(0.1, 0, 0, 0), 3}, Trouble{rates(0.1, 0.1, 0, 0), 4},
                    Trouble{rates(0, 0, 0, 0.1), 5}, Trouble{rates(0, 0.1, 0.05, 0.1), 6},
                    Trouble{rates(0.1, 0.1, 0.02, 0.1), 7}));

TEST(BusOff, OfADriveLosesThatDriveAlone) {
  Scene scene(loadText(genericPair() + "  alone: {joints: [right]}\n"));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({2.0}, 4s, 1).success);
  scene.port("left").forceBusOff();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == NodeHealth::lost; }, 1s));
  scene.run(5s);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_NEAR(scene.position("right"), 2.0, 1e-3);
  scene.port("left").requestRecovery();
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 6s)) << scene.told();
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_TRUE(scene.procedure(ProcedureKind::recover, "left").success);
}

TEST(BusOff, OfTheMasterStopsAllDrivesAndRecovers) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({2.0, -2.0}, 4s).success);
  scene.run(2s);
  scene.robot().port().forceBusOff();
  scene.run(1s);
  for (const char* axis : {"left", "right"}) {
    EXPECT_FALSE(scene.truth(axis).power_stage_on) << axis;
    EXPECT_FALSE(scene.truth(axis).moving) << axis;
    EXPECT_EQ(scene.state(axis).health, NodeHealth::lost) << axis;
  }
  scene.robot().port().requestRecovery();
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  const auto recovered = scene.procedure(ProcedureKind::recover);
  EXPECT_TRUE(recovered.success) << recovered.message;
}

/// An hour of random commands, faults, losses and reboots of two generic drives and a Damiao.
TEST(Soak, AnHourOfEverythingKeepsTheInvariants) {
  LoadedRobot loaded = loadFile("demo.yaml");
  for (auto& axis : loaded.robot.axes) axis.homing.reset();
  Scene scene(std::move(loaded), 11);
  ASSERT_TRUE(scene.boot());
  std::mt19937 random(11);
  const auto pick = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
  const auto& axes = scene.loaded().robot.axes;
  const char* const faults[] = {"overcurrent", "overvoltage", "encoder", "blocked_rotor",
                                "power_cycle", "silent",      "0x7500",  "following_error"};
  std::vector<Time> told_off(axes.size(), scene.now());
  unsigned violations = 0;
  scene.watch([&] {
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const drive::AxisState& state = scene.robot().robot().axes()[i].state();
      const sim::DriveTruth truth = scene.world().drive(i).truth(scene.now());
      const double at = scene.position(i);
      const bool inside = at < *axes[i].limits.upper + 0.05 && at > *axes[i].limits.lower - 0.05;
      const bool streaming = state.ready_for_motion && state.mode->cyclic;
      // The Damiao joint plans its own way to each target and may catch up after lost frames with
      // the 1.5 times that its profile allows (6080h).
      const double most = axes[i].profile->output_shaft ? 1.5 : 1.1;
      const bool slow = !streaming || std::abs(scene.velocity(i)) < *axes[i].limits.velocity * most;
      const bool off = state.feedback_valid && state.state == drive::State::switch_on_disabled;
      if (!off || !truth.power_stage_on) told_off[i] = scene.now();
      const bool honest = scene.now() - told_off[i] < 50ms;
      if ((inside && slow && honest) || ++violations > 5) continue;
      ADD_FAILURE() << axes[i].name << " at " << toSeconds(scene.now() - Time{}) << " s: position "
                    << at << ", velocity " << scene.velocity(i) << ", inside " << inside
                    << ", slow " << slow << ", honest " << honest;
    }
  });
  const Time end = scene.now() + std::chrono::hours(1);
  unsigned enabled = 0;
  while (scene.now() < end && violations <= 5) {
    const std::size_t i = pick(4);
    const std::string& name = axes[i].name;
    const double goal = 0.02 * pick(100) - 1.0;
    switch (pick(12)) {
      case 0:
        scene.inject(name, faults[pick(8)]);
        scene.run(500ms);
        scene.inject(name, "clear");
        break;
      case 1:
        scene.port(name).setAttached(false);
        scene.run(std::chrono::milliseconds(50 + pick(800)));
        scene.port(name).setAttached(true);
        break;
      case 2:
        scene.world().bus().faults().setRates(rates(0.02, 0.01, 0.005, 0.01));
        scene.run(2s);
        scene.world().bus().faults().setRates({});
        break;
      case 3:
        (void)scene.procedure(ProcedureKind::disable, name);
        break;
      case 4:
        (void)scene.begin(ProcedureKind::quick_stop, name);
        break;
      case 5:
      case 6:
        (void)scene.procedure(ProcedureKind::recover);
        for (std::size_t k = 0; k < axes.size(); ++k) {
          if (scene.world().drive(k).truth(scene.now()).power_stage_on) ++enabled;
        }
        break;
      case 7:
        (void)scene.setpoint(name, goal);
        break;
      default:
        (void)scene.move({goal, -goal, goal, 0.5 * goal}, 3s);
    }
    scene.run(std::chrono::milliseconds(100 + pick(4000)));
  }
  EXPECT_EQ(scene.badFloats(), 0u);
  EXPECT_GT(enabled, 200u) << "the soak must not idle";
}

}  // namespace
}  // namespace cia402
