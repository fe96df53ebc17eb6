// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A disturbed bus.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using fieldbus::Health;
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
  for (bus::AxisUnit& unit : scene.robot().network().cycle().units()) {
    drive::Axis& axis = unit.axis;
    if (axis.state().health == Health::ready) continue;
    if (axis.state().health == Health::booting) continue;
    EXPECT_NE(axis.device().problem(), "") << axis.config().name;
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
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::lost; }, 1s));
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
    EXPECT_EQ(scene.state(axis).health, Health::lost) << axis;
  }
  scene.robot().port().requestRecovery();
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  const auto recovered = scene.procedure(ProcedureKind::recover);
  EXPECT_TRUE(recovered.success) << recovered.message;
}

}  // namespace
}  // namespace cia402
