// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Velocity, acceleration and effort of the true motor in every mode of both families, after another
// mode that left its own ramps in the drive.
#include "system/motion_watch.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;

/// The widest motion that the mode can be asked for: there and back.
void exert(Scene& scene, const std::string& axis, double velocity, double effort) {
  const ControlKind kind = scene.state(axis).mode->kind;
  if (kind == ControlKind::position) {
    for (const double goal : {-1.5, 1.2}) {
      ASSERT_EQ(scene.setpoint(axis, goal), "");
      scene.run(2500ms);
      EXPECT_NEAR(scene.position(axis), goal, 0.02);
    }
  } else {
    const double value = kind == ControlKind::velocity ? velocity : 0.3 * effort;
    for (const double sign : {-1.0, 1.0}) scene.stream(axis, sign * value, 500ms);
    scene.run(300ms);
  }
}

/// Against a rotor that does not move.
void push(Scene& scene, const std::string& axis, double velocity, double effort) {
  scene.inject(axis, "blocked_rotor");
  const ControlKind kind = scene.state(axis).mode->kind;
  const double value = kind == ControlKind::position   ? 0.0
                       : kind == ControlKind::velocity ? velocity
                                                       : 2.0 * effort;
  const int times = kind == ControlKind::torque ? 300 : 15;  // 6087h: 1 N m in a second
  for (int i = 0; i < times; ++i) {
    (void)scene.setpoint(axis, value);  // a following error ends it
    scene.run(20ms);
  }
}

class DamiaoMode : public testing::TestWithParam<const char*> {};

TEST_P(DamiaoMode, KeepsTheLimitsOfVelocityAccelerationAndEffort) {
  constexpr double velocity = 2.0, acceleration = 15.0, effort = 5.0;
  Scene scene(loadText(
      damiaoJoint(", command_timeout_action: coast, modes: [" + std::string(GetParam()) + "]")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);  // cyclic_position: steep ramps
  const auto switched = scene.procedure(ProcedureKind::set_mode, "joint", GetParam());
  ASSERT_TRUE(switched.success) << switched.message;
  Motion motion(scene, "joint");
  exert(scene, "joint", velocity, effort);
  EXPECT_LE(motion.fastest, velocity * 1.01);
  EXPECT_GT(motion.fastest, velocity * 0.9) << "the test asked for too little";
  if (scene.state("joint").mode->kind != ControlKind::torque) {
    // Of a stream the drive plans its own way to each set-point, with steeper ramps than the
    // limit's.
    const bool streamed = std::string(GetParam()) == "cyclic_position";
    EXPECT_LE(motion.hardest, acceleration * (streamed ? 1.2 : 1.1));
  }
  motion.forget();
  push(scene, "joint", velocity, effort);
  EXPECT_LE(motion.strongest, effort * 1.01);
  EXPECT_GT(motion.strongest, effort * 0.3) << "the test asked for too little";
}

INSTANTIATE_TEST_SUITE_P(All, DamiaoMode,
                         testing::Values("cyclic_position", "profile_position", "position_velocity",
                                         "position_velocity_torque", "profile_velocity",
                                         "cyclic_velocity", "velocity_torque", "profile_torque"),
                         [](const auto& tested) { return std::string(tested.param); });

class GenericMode : public testing::TestWithParam<const char*> {};

TEST_P(GenericMode, KeepsTheLimitsOfVelocityAccelerationAndEffort) {
  constexpr double velocity = 1.5, acceleration = 4.0;
  constexpr double effort = 120.0 / (0.64 * 100.0) * 1000.0;  // in 1/1000 of the rated torque
  Scene scene(loadText(genericPair(", write: [{object: following_error_window, value: 0.5}]")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  const auto switched = scene.procedure(ProcedureKind::set_mode, "left", GetParam());
  ASSERT_TRUE(switched.success) << switched.message;
  Motion motion(scene, "left");
  exert(scene, "left", velocity, 0.0);
  EXPECT_LE(motion.fastest, velocity * 1.01);
  EXPECT_GT(motion.fastest, velocity * 0.9) << "the test asked for too little";
  EXPECT_LE(motion.hardest, acceleration * 1.1);
  motion.forget();
  push(scene, "left", velocity, 0.0);
  EXPECT_LE(motion.strongest, effort * 1.01);
  EXPECT_GT(motion.strongest, effort * 0.3) << "the test asked for too little";
}

INSTANTIATE_TEST_SUITE_P(All, GenericMode,
                         testing::Values("cyclic_position", "profile_position", "profile_velocity",
                                         "cyclic_velocity"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace cia402
