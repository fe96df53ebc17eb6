// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every mode of the SV660C on a whole robot, judged by its motor.
#include <cmath>

#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::HasSubstr;

constexpr double kUserUnit = 6.283185307179586 / (50.0 * 100000.0);  // rad of the joint

class Sv660cMode : public testing::TestWithParam<const char*> {};

// 60C1h, 607Ah, 60FFh and 6071h are 0 from the factory, and the joint stands elsewhere.
TEST_P(Sv660cMode, MovesNothingWhenItIsEnabled) {
  for (const double start : {-2.3, 1.9}) {
    Scene scene(loadText(sv660cJoint(", mode: " + std::string(GetParam()),
                                     "initial_position: " + std::to_string(start))));
    ASSERT_TRUE(scene.boot()) << scene.told();
    scene.forget();
    const auto enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message << scene.told();
    scene.run(1s);
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << scene.told();
    EXPECT_EQ(scene.state("joint").state, State::operation_enabled);
    EXPECT_LT(scene.seen("joint").travel(), 2.0 * kUserUnit);
    EXPECT_NEAR(scene.state("joint").position, start, 2.0 * kUserUnit);
  }
}

INSTANTIATE_TEST_SUITE_P(AsTheFirst, Sv660cMode, testing::Values("ip", "pp", "pv", "pt"),
                         [](const auto& tested) { return std::string(tested.param); });

struct Sv660cModes : testing::Test {
  Scene scene{loadText(sv660cJoint({}, "initial_position: 0.4"))};

  void SetUp() override {
    ASSERT_TRUE(scene.boot()) << scene.told();
    const auto enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message << scene.told();
  }
  void enter(const char* mode) {
    scene.forget();
    const auto switched = scene.procedure(ProcedureKind::set_mode, "joint", mode);
    ASSERT_TRUE(switched.success) << mode << ": " << switched.message;
    EXPECT_LT(scene.seen("joint").travel(), 1e-3) << mode;
  }
  std::int64_t shownMode() {
    return sim::asSigned(*scene.drive("joint").dictionary().find({0x6061, 0}));
  }
};

TEST_F(Sv660cModes, PositionsAreReachedWithinTheirLimits) {
  double goal = -0.7;
  for (const auto& [mode, number] :
       {std::pair("pp", 1), std::pair("ip", 7), std::pair("pp", 1), std::pair("ip", 7)}) {
    enter(mode);
    EXPECT_EQ(shownMode(), number);
    scene.forget();
    ASSERT_EQ(scene.setpoint("joint", goal), "") << mode;
    scene.run(4s);
    EXPECT_NEAR(scene.position("joint"), goal, 4.0 * kUserUnit) << mode << scene.told();
    EXPECT_NEAR(scene.state("joint").position, goal, 4.0 * kUserUnit) << mode;
    EXPECT_LE(scene.seen("joint").fastest, 1.5 * 1.02) << mode;
    goal = -goal;
  }
}

TEST_F(Sv660cModes, VelocitiesAreReachedAndEndWithTheirStream) {
  for (const auto& [mode, speed] : {std::pair("pv", 0.5), std::pair("csv", -0.7)}) {
    enter(mode);
    EXPECT_EQ(shownMode(), 3);
    scene.stream("joint", speed, 1s);
    EXPECT_NEAR(scene.velocity("joint"), speed, 1e-3) << mode;
    EXPECT_NEAR(scene.state("joint").velocity, speed, 1e-2) << mode;
    scene.run(1s);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << mode;
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << mode;
  }
}

// 11.95 N m are a tenth of the rated torque. The simulated motor takes 0.03 of it for friction and
// gains 1000 turns/s^2 by all of it: 70 turns/s^2, or 8.796 rad/s^2 of the joint.
TEST_F(Sv660cModes, ATorquePushesAsHardAsItSaysUpToTheSpeedLimit) {
  enter("pt");
  EXPECT_EQ(shownMode(), 4);
  const double before = scene.position("joint");
  scene.stream("joint", 11.95, 60ms);
  const double early = scene.velocity("joint");
  scene.stream("joint", 11.95, 40ms);
  EXPECT_NEAR(scene.velocity("joint") - early, 8.796 * 0.04, 0.02);
  scene.stream("joint", 11.95, 300ms);
  EXPECT_LT(scene.seen("joint").fastest, 1.5 * 1.1 * 1.01) << "607Fh bounds it [L1245]";
  EXPECT_GT(scene.velocity("joint"), 1.3);
  EXPECT_GT(scene.position("joint"), before);
  scene.run(2s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << "the halt bit braked it" << scene.told();
}

TEST_F(Sv660cModes, ATrajectoryIsFollowedInInterpolatedPositionMode) {
  double worst = 0.0;
  const auto answer = scene.move({-0.8}, 3s);
  ASSERT_TRUE(answer.success) << answer.message;
  scene.watch([&] {
    const auto& state = scene.state("joint");
    const double commanded = state.position + state.following_error;
    worst = std::max(worst, std::fabs(commanded - scene.position("joint")));
  });
  scene.run(4s);
  scene.watch({});
  EXPECT_NEAR(scene.position("joint"), -0.8, 4.0 * kUserUnit) << scene.told();
  EXPECT_THAT(scene.told(), testing::Not(HasSubstr("missed")));
  // 0.6 rad/s in the middle: 4 ms of the loop, 4 ms of delay, and what passes until it counts.
  EXPECT_GT(worst, 0.6 * 0.008);
  EXPECT_LT(worst, 0.6 * 0.012);
}

TEST_F(Sv660cModes, AHaltHoldsInEachMode) {
  const auto begin = [this](const std::string& mode) {
    if (mode == "pv") scene.stream("joint", 0.5, 600ms);
    if (mode == "pt") scene.stream("joint", 8.0, 300ms);
    if (mode == "pp" || mode == "ip") {
      ASSERT_EQ(scene.setpoint("joint", scene.position("joint") > 0.0 ? -1.5 : 1.5), "");
      scene.run(700ms);
    }
    ASSERT_GT(std::fabs(scene.velocity("joint")), 0.2) << mode;
  };
  for (const char* mode : {"ip", "pp", "pv", "pt"}) {
    enter(mode);
    begin(mode);
    const auto halted = scene.procedure(ProcedureKind::halt, "joint");
    ASSERT_TRUE(halted.success) << mode << ": " << halted.message;
    scene.run(100ms);
    scene.forget();
    scene.run(1s);
    EXPECT_LT(scene.seen("joint").travel(), 1e-3) << mode;
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << mode;
    const auto enabled = scene.procedure(ProcedureKind::enable, "joint");
    ASSERT_TRUE(enabled.success) << mode << ": " << enabled.message;
    scene.run(500ms);
    EXPECT_LT(scene.seen("joint").travel(), 1e-3) << mode;
  }
}

// 6085h is 2 * limits.acceleration: 1.5 rad/s end after 0.14 rad. 6084h is limits.acceleration.
TEST_F(Sv660cModes, QuickStopAndDisableBrakeByTheirRamps) {
  struct StopWay {
    ProcedureKind kind;
    double way;  // rad
  };
  for (const StopWay& c :
       {StopWay{ProcedureKind::quick_stop, 0.1406}, StopWay{ProcedureKind::disable, 0.2813}}) {
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "joint").success) << scene.told();
    ASSERT_EQ(scene.setpoint("joint", scene.position("joint") > 0.0 ? -2.4 : 2.4), "");
    ASSERT_TRUE(scene.runUntil([this] { return std::fabs(scene.velocity("joint")) > 1.49; }, 3s));
    const double from = scene.position("joint");
    const auto stopped = scene.procedure(c.kind, "joint");
    ASSERT_TRUE(stopped.success) << stopped.message;
    EXPECT_LT(std::fabs(scene.position("joint") - from), c.way + 1.5 * 0.03);
    EXPECT_GT(std::fabs(scene.position("joint") - from), 0.5 * c.way);
    scene.run(500ms);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-6);
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
    EXPECT_EQ(scene.state("joint").state, State::switch_on_disabled);
  }
}

}  // namespace
}  // namespace cia402
