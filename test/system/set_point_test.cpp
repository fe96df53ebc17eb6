// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Quick calls on a moving axis, late cycles during a stop: what the motor does.
#include <deque>

#include "system/field_profile.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

constexpr double kVelocity = 1.5;  // limit of genericPair()

TEST(SetPoints, AVelocityThatIsNobodysAnyMoreEndsWithTheCallThatTookItsStream) {
  ReadyScene scene(genericPair(), "cyclic_velocity");
  ASSERT_EQ(scene.setpoint("left", 1.0), "");
  scene.run(8ms);
  (void)declare(scene, "left", 0.4);
  scene.run(500ms);
  scene.forget();
  scene.run(2s);
  EXPECT_LT(scene.seen("left").travel(), 1e-3);
}

TEST(SetPoints, AStreamThatCreepsEndsWithTheCallThatTookIt) {
  ReadyScene scene(genericPair(), "cyclic_velocity");
  scene.stream("left", 0.008, 300ms);
  (void)declare(scene, "left", 0.4);
  scene.run(1s);
  scene.forget();
  scene.run(5s);
  EXPECT_LT(scene.seen("left").travel(), 1e-3);
}

TEST(SetPoints, ASecondHaltMovesNothing) {
  ReadyScene scene(genericPair());
  scene.stream("left", 2.0, 700ms);
  ASSERT_GT(std::abs(scene.velocity("left")), 1.0);
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt, "left").success);
  scene.run(300ms);
  scene.forget();
  EXPECT_TRUE(scene.procedure(ProcedureKind::halt, "left").success);
  scene.run(1s);
  EXPECT_LT(scene.seen("left").travel(), 1e-3);
  EXPECT_LT(scene.seen("left").fastest, 0.02);
}

TEST(SetPoints, DeclaringThePositionOfAHaltedAxisMovesNothing) {
  for (const std::string& yaml : {genericPair(), damiaoJoint()}) {
    ReadyScene scene(yaml);
    const std::string axis = scene.loaded().robot.axes[0].name;
    scene.stream(axis, scene.state(axis).position + 0.3, 400ms);
    ASSERT_TRUE(scene.procedure(ProcedureKind::halt, axis).success);
    scene.run(300ms);
    scene.forget();
    const bus::Answer answer = declare(scene, axis, 0.3);
    scene.run(1s);
    EXPECT_LT(scene.seen(axis).travel(), 1e-3) << answer.message;
    EXPECT_NE(scene.state(axis).state, drive::State::fault);
  }
}

TEST(SetPoints, ALateCycleDuringAHaltMovesNothingAtOnce) {
  for (const std::string& yaml : {genericPair(), damiaoJoint()}) {
    ReadyScene scene(yaml);
    const std::string axis = scene.loaded().robot.axes[0].name;
    const double limit = *scene.loaded().robot.axes[0].limits.velocity;
    const double towards = scene.state(axis).position > 1.0 ? -1.5 : 2.0;
    scene.stream(axis, towards, 400ms);
    (void)scene.begin(ProcedureKind::halt, axis);
    scene.run(20ms);
    scene.forget();
    scene.robot().freeze(60ms);
    scene.run(2s);
    EXPECT_LT(scene.seen(axis).fastest, 1.05 * limit) << axis;
    scene.forget();
    scene.run(500ms);
    EXPECT_LT(scene.seen(axis).travel(), 1e-3);
  }
}

TEST(SetPoints, ALateCycleDuringTheShutdownStartsNoVelocityAnew) {
  ReadyScene scene(genericPair(), "cyclic_velocity");
  scene.stream("left", 1.0, 700ms);
  scene.robot().network().beginShutdown(scene.now());
  scene.run(120ms);  // of 250 ms
  const double speed = std::abs(scene.velocity("left"));
  ASSERT_LT(speed, 0.8);
  scene.robot().freeze(12ms);
  scene.forget();
  scene.run(2s);
  EXPECT_LT(scene.seen("left").fastest, speed + 0.05);
  EXPECT_LT(scene.seen("left").travel(), speed * speed / (2 * 4.0) + speed * 0.03 + 0.01);
}

TEST(SetPoints, ATrajectoryGoesOnFromRestAfterALateCycle) {
  ReadyScene scene(genericPair());
  ASSERT_TRUE(scene.move({1.2, 1.2}, 2s).success);
  scene.run(1s);
  ASSERT_GT(scene.velocity("left"), 0.8);
  scene.robot().freeze(100ms);
  scene.run(101ms);
  double before = scene.velocity("left"), hardest = 0.0;
  ASSERT_LT(before, 0.1);  // it waited at the last target
  for (int i = 0; i < 50; ++i) {
    scene.run(20ms);
    hardest = std::max(hardest, (scene.velocity("left") - before) / 0.020);
    before = scene.velocity("left");
  }
  EXPECT_LT(hardest, 4.0 * 1.3) << "rad/s^2; the limit is 4, the motor swings a little";
  scene.run(3s);
  EXPECT_NEAR(scene.position("left"), 1.2, 1e-3);
  EXPECT_THAT(scene.told(), HasSubstr("goal reached"));
}

TEST(SetPoints, ADisableWhoseDriveIsNotHeardDoesNotCutItsQuickStop) {
  ReadyScene scene(genericPair(), "cyclic_velocity");
  scene.stream("left", kVelocity, 800ms);
  ASSERT_GT(std::abs(scene.velocity("left")), 1.3);
  sim::FaultRule rule;  // no TPDO arrives any more
  rule.id = 0x181;
  rule.count = 1000000;
  scene.world().bus().faults().add(rule);
  const Time end = scene.now() + 300ms;
  while (scene.now() < end && scene.axis("left").state().state != drive::State::unknown) {
    (void)scene.setpoint("left", kVelocity);
    scene.run(4ms);
  }
  scene.run(8ms);
  scene.forget();
  (void)scene.begin(ProcedureKind::disable, "left");
  while (std::abs(scene.velocity("left")) > 0.05) {
    ASSERT_TRUE(scene.truth("left").power_stage_on)
        << "coasts at " << scene.velocity("left") << " rad/s";
    scene.run(1ms);
  }
  // By 6085h, twice the acceleration limit, and what passed until it was told.
  EXPECT_LT(scene.seen("left").travel(), kVelocity * kVelocity / (2 * 8.0) + kVelocity * 0.02);
  scene.run(6s);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
}

TEST(SetPoints, AHaltDuringAQuickStopAnswersAtRest) {
  ReadyScene scene(genericPair());
  scene.stream("left", 2.0, 700ms);
  (void)scene.begin(ProcedureKind::quick_stop, "left");
  scene.run(4ms);
  const bus::Answer answer = scene.procedure(ProcedureKind::halt, "left");
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_LT(std::abs(scene.velocity("left")), 0.02) << answer.message;
}

TEST(SetPoints, AHaltInTheSameCycleTakesNoQuickStopBack) {
  for (const auto kind : {ProcedureKind::quick_stop, ProcedureKind::disable}) {
    ReadyScene scene(genericPair());
    scene.stream("left", 2.0, 700ms);
    const double speed = scene.velocity("left");
    ASSERT_GT(speed, 1.0);
    scene.forget();
    (void)scene.begin(kind, "left");
    const bus::Answer answer = scene.procedure(ProcedureKind::halt, "left");
    EXPECT_TRUE(answer.success) << answer.message;
    // 6085h is twice the acceleration limit; four cycles until it brakes.
    EXPECT_LT(scene.seen("left").travel(), 1.05 * (speed * speed / (2 * 8.0) + speed * 0.016));
    EXPECT_LT(std::abs(scene.velocity("left")), 0.02) << answer.message;
  }
}

/// How far a motor turned back, at most.
struct Reversal {
  double furthest = -1e9, back = 0.0;
  void see(double position) {
    furthest = std::max(furthest, position);
    back = std::max(back, furthest - position);
  }
};

struct EarlyStop {
  const char* name;
  std::string yaml;
  const char* mode;
  double set_point;
  friend std::ostream& operator<<(std::ostream& out, const EarlyStop& stop) {
    return out << stop.name;
  }
};

class AStopJustAfterMotionBegan : public testing::TestWithParam<EarlyStop> {};

TEST_P(AStopJustAfterMotionBegan, IsAnsweredAtRestAndTurnsNothingBack) {
  for (const auto kind : {ProcedureKind::halt, ProcedureKind::disable, ProcedureKind::quick_stop}) {
    for (const Duration after : {4ms, 8ms, 12ms, 20ms, 40ms, 60ms}) {
      ReadyScene scene(GetParam().yaml);
      const std::string axis = scene.loaded().robot.axes[0].name;
      ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, axis, GetParam().mode).success);
      scene.run(200ms);
      ASSERT_EQ(scene.setpoint(axis, GetParam().set_point), "");
      scene.run(after);
      Reversal reversal;
      scene.watch([&] { reversal.see(scene.position(axis)); });
      const bus::Answer answer = scene.procedure(kind, axis);
      EXPECT_TRUE(answer.success) << answer.message;
      const double told_at = scene.position(axis);
      scene.run(500ms);
      const std::string where =
          std::string(toString(kind)) + " after " + std::to_string(toSeconds(after)) + " s";
      EXPECT_NEAR(scene.position(axis), told_at, 2e-4) << where << ": " << answer.message;
      EXPECT_LT(reversal.back, 2e-4) << where;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    In, AStopJustAfterMotionBegan,
    testing::Values(EarlyStop{"generic_csp", genericPair(), "cyclic_position", 2.0},
                    EarlyStop{"generic_csv", genericPair(), "cyclic_velocity", 1.5},
                    EarlyStop{"generic_pp", genericPair(), "profile_position", 2.0},
                    EarlyStop{"generic_pv", genericPair(), "profile_velocity", 1.5},
                    EarlyStop{"damiao_csp", damiaoJoint(), "cyclic_position", 1.9},
                    EarlyStop{"damiao_csv", damiaoJoint(), "cyclic_velocity", 1.5},
                    EarlyStop{"damiao_pp", damiaoJoint(), "profile_position", 1.9},
                    EarlyStop{"damiao_pos_vel", damiaoJoint(), "position_velocity", 1.9}),
    [](const auto& tested) { return tested.param.name; });

/// Another mode is asked for just after a drive that plans its motion was sent off.
class AModeJustAfterMotionBegan : public testing::TestWithParam<EarlyStop> {};

TEST_P(AModeJustAfterMotionBegan, IsTakenAtRestOrNotAndTurnsNothingBack) {
  for (const char* other : {"cyclic_position", "cyclic_velocity"}) {
    for (const Duration after : {0ms, 1ms, 4ms, 8ms, 12ms, 20ms, 40ms, 60ms}) {
      ReadyScene scene(GetParam().yaml, GetParam().mode);
      const std::string axis = scene.loaded().robot.axes[0].name;
      scene.run(100ms);
      ASSERT_EQ(scene.setpoint(axis, GetParam().set_point), "");
      scene.run(after);
      Reversal reversal;
      bool on = true;
      double switched_at = 0.0;  // the power stage, of a drive that takes a mode without it only
      scene.watch([&] {
        reversal.see(scene.position(axis));
        if (scene.truth(axis).power_stage_on == on) return;
        on = !on;
        switched_at = std::max(switched_at, std::abs(scene.velocity(axis)));
      });
      const bus::Answer answer = scene.procedure(ProcedureKind::set_mode, axis, other);
      const std::string where = std::string(other) + " after " + std::to_string(toSeconds(after)) +
                                " s: " + answer.message;
      const double told_at = scene.position(axis);
      if (answer.success) {
        EXPECT_LT(std::abs(scene.velocity(axis)), 0.02) << where;
      }
      scene.run(4s);
      EXPECT_LT(reversal.back, 2e-4) << where;
      EXPECT_LT(switched_at, 0.01) << where;
      EXPECT_EQ(scene.axis(axis).modeName(), answer.success ? other : GetParam().mode) << where;
      const bool goal = std::string(GetParam().mode).find("position") != std::string::npos;
      if (answer.success || goal) {
        EXPECT_NEAR(scene.position(axis), answer.success ? told_at : GetParam().set_point, 1e-3)
            << where;
      }
      EXPECT_LT(std::abs(scene.velocity(axis)), 0.02) << where;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    From, AModeJustAfterMotionBegan,
    testing::Values(EarlyStop{"generic_pp", genericPair(), "profile_position", 2.0},
                    EarlyStop{"generic_pv", genericPair(), "profile_velocity", 1.5},
                    EarlyStop{"damiao_pp", damiaoJoint(), "profile_position", 1.9},
                    EarlyStop{"damiao_pos_vel", damiaoJoint(), "position_velocity", 1.9},
                    EarlyStop{"damiao_pos_vel_torque", damiaoJoint(), "position_velocity_torque",
                              1.9}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace cia402
