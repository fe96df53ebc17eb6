// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What follows a quick stop is what the configuration says, however often.
#include <cmath>

#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

struct Case {
  const char* name;
  std::string yaml;
  std::string axis;
  std::uint64_t holds, disables;  // 605Ah
};

void PrintTo(const Case& tested, std::ostream* out) { *out << tested.name; }

std::vector<Case> cases(const std::string& more) {
  // CiA 402-2, 605Ah: 6, quick stop ramp and stay; the maker of the Damiao has 4 for it [L133-138].
  return {{"Generic", genericPair(more), "left", 6, 2},
          {"Damiao", damiaoJoint(more), "joint", 4, 2}};
}

class QuickStop : public testing::TestWithParam<Case> {
 protected:
  Scene scene{loadText(GetParam().yaml)};
  const std::string axis = GetParam().axis;

  void SetUp() override {
    ASSERT_TRUE(scene.boot());
    enable();
  }
  void enable() {
    const auto enabled = scene.procedure(ProcedureKind::enable, axis);
    ASSERT_TRUE(enabled.success) << enabled.message;
  }
  bus::Answer stopInMotion(double goal) {
    EXPECT_EQ(scene.setpoint(axis, goal), "");
    scene.run(400ms);
    EXPECT_GT(std::fabs(scene.velocity(axis)), 0.3);
    return scene.procedure(ProcedureKind::quick_stop, axis);
  }
  std::uint64_t option() { return scene.drive(axis).dictionary().find({0x605A, 0})->number; }
  void expectStands(Duration duration) {
    scene.forget();
    scene.run(duration);
    EXPECT_LT(scene.seen(axis).travel(), 2e-3);
  }
};

using QuickStopThatHolds = QuickStop;

TEST_P(QuickStopThatHolds, StaysUnderPowerUntilItIsEnabledAndDoesSoAgain) {
  double goal = 0.0;
  for (int round = 0; round < 2; ++round, goal = 1.0) {
    const auto stopped = stopInMotion(goal > 0.5 ? goal : scene.position(axis) > 0.5 ? 0.0 : 1.2);
    EXPECT_TRUE(stopped.success) << stopped.message;
    EXPECT_THAT(stopped.message, HasSubstr("holds its position in quick stop active; enable to"));
    EXPECT_EQ(option(), GetParam().holds);
    EXPECT_EQ(scene.state(axis).state, drive::State::quick_stop_active);
    expectStands(2s);
    EXPECT_TRUE(scene.truth(axis).power_stage_on);
    EXPECT_THAT(scene.setpoint(axis, 0.5), HasSubstr("quick stop active"));
    enable();
    expectStands(500ms);
  }
  ASSERT_EQ(scene.setpoint(axis, 0.6), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position(axis), 0.6, 5e-3);
}

TEST_P(QuickStopThatHolds, IsLeftByDisable) {
  const auto stopped = stopInMotion(scene.position(axis) > 0.5 ? 0.0 : 1.2);
  ASSERT_TRUE(stopped.success) << stopped.message;
  const auto disabled = scene.procedure(ProcedureKind::disable, axis);
  EXPECT_TRUE(disabled.success) << disabled.message;
  EXPECT_FALSE(scene.truth(axis).power_stage_on);
}

TEST_P(QuickStopThatHolds, ComesBackAfterAPulledCable) {
  scene.robot().port().setAttached(false);  // the driver's end of it
  scene.run(1s);
  scene.robot().port().setAttached(true);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 12s)) << scene.told();
  scene.run(500ms);
  const auto recovered = scene.procedure(ProcedureKind::recover, axis);
  EXPECT_TRUE(recovered.success) << recovered.message;
  EXPECT_EQ(option(), GetParam().holds);
}

TEST_P(QuickStopThatHolds, ComesBackAfterThatWhileItHolds) {
  const auto stopped = stopInMotion(scene.position(axis) > 0.5 ? 0.0 : 1.2);
  ASSERT_TRUE(stopped.success) << stopped.message;
  scene.robot().port().setAttached(false);
  scene.run(1s);
  scene.robot().port().setAttached(true);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 12s)) << scene.told();
  scene.run(500ms);
  const auto recovered = scene.procedure(ProcedureKind::recover, axis);
  EXPECT_TRUE(recovered.success) << recovered.message;
}

INSTANTIATE_TEST_SUITE_P(Drives, QuickStopThatHolds, testing::ValuesIn(cases(", quick_stop: hold")),
                         [](const auto& tested) { return std::string(tested.param.name); });

using QuickStopThatDisables = QuickStop;

TEST_P(QuickStopThatDisables, EndsWithoutPower) {
  const auto stopped = stopInMotion(scene.position(axis) > 0.5 ? 0.0 : 1.2);
  EXPECT_TRUE(stopped.success) << stopped.message;
  EXPECT_THAT(stopped.message, HasSubstr("stopped and disabled"));
  EXPECT_EQ(option(), GetParam().disables);
  EXPECT_FALSE(scene.truth(axis).power_stage_on);
}

INSTANTIATE_TEST_SUITE_P(Drives, QuickStopThatDisables, testing::ValuesIn(cases("")),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace cia402
