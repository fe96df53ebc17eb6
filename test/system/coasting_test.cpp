// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// An axis that coasts is not switched on before it stands: the drive would pull it back.
#include <cmath>

#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

struct Coasting : testing::Test {
  Scene scene{loadText(genericPair(", modes: [csp, csv]"))};
  double last = 0.0, hardest = 0.0, powered_at = 0.0;
  bool was_on = true;

  /// The left axis runs at 1.2 rad/s; then a fault takes its power away.
  void SetUp() override {
    ASSERT_TRUE(scene.boot());
    const auto enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
    ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "csv").success);
    scene.stream("left", 1.2, 1s);
    ASSERT_NEAR(scene.velocity("left"), 1.2, 0.02);
    scene.inject("left", "overcurrent");
    scene.run(20ms);
    ASSERT_FALSE(scene.truth("left").power_stage_on);
    ASSERT_GT(scene.velocity("left"), 0.5) << "it coasts";
    last = scene.velocity("left");
    was_on = false;
    scene.watch([this] {
      const double velocity = scene.velocity("left");
      const bool on = scene.truth("left").power_stage_on;
      if (on && !was_on) powered_at = std::fabs(velocity);
      if (on) hardest = std::max(hardest, std::fabs(velocity - last) / 0.001);
      was_on = on;
      last = velocity;
    });
  }

  void expectSoft() const {
    EXPECT_LT(powered_at, 0.02) << "rad/s when the power came";
    EXPECT_LT(hardest, 4.0) << "rad/s^2, the limit of the axis";
    EXPECT_TRUE(was_on);
  }
};

TEST_F(Coasting, RecoverAtOnceWaitsUntilItStands) {
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(recovered.success) << recovered.message;
  scene.run(1s);
  expectSoft();
}

TEST_F(Coasting, EnableAfterClearFaultsWaitsUntilItStands) {
  const auto cleared = scene.procedure(ProcedureKind::clear_faults, "left");
  ASSERT_TRUE(cleared.success) << cleared.message;
  const auto enabled = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_TRUE(enabled.success) << enabled.message;
  scene.run(1s);
  expectSoft();
}

/// What stops is asked for while nothing is known yet of how the axis moves: its power went, by a
/// fault, just after it had begun to move.
struct CoastingAtOnce : testing::TestWithParam<ProcedureKind> {
  Scene scene{loadText(genericPair(", modes: [csp, csv]"))};

  void SetUp() override {
    ASSERT_TRUE(scene.boot());
    const auto enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
    ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "csv").success);
    scene.run(200ms);
    ASSERT_EQ(scene.setpoint("left", 0.05), "");
    scene.run(12ms);
    scene.inject("left", "overcurrent");
    scene.run(8ms);
    ASSERT_FALSE(scene.truth("left").power_stage_on);
    ASSERT_GT(scene.velocity("left"), 0.02) << "it coasts";
  }
};

TEST_P(CoastingAtOnce, IsNotAnsweredBeforeItStands) {
  const auto answer = scene.procedure(GetParam(), "left");
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_NEAR(scene.velocity("left"), 0.0, 0.01) << answer.message;
}

INSTANTIATE_TEST_SUITE_P(Stop, CoastingAtOnce,
                         testing::Values(ProcedureKind::disable, ProcedureKind::halt,
                                         ProcedureKind::quick_stop),
                         [](const auto& stop) { return std::string(toString(stop.param)); });

TEST_F(Coasting, DisableOfTheWholeBusNamesTheFault) {
  const auto disabled = scene.procedure(ProcedureKind::disable);
  EXPECT_TRUE(disabled.success) << disabled.message;
  EXPECT_THAT(disabled.message, HasSubstr("disable done on 2 of 2 axes; left: disabled; "));
  EXPECT_THAT(disabled.message, HasSubstr("0x2310"));
  EXPECT_THAT(disabled.message, testing::Not(HasSubstr("right")));
}

}  // namespace
}  // namespace cia402
