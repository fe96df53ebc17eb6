// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Limits that a Damiao does not have, windows that it has, and what the driver sees for itself.
#include "system/damiao_scene.h"
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

class DamiaoPosition : public testing::TestWithParam<const char*> {};

// limits of damiaoJoint(): -2 to 2 rad; the drive has none of its own.
TEST_P(DamiaoPosition, IsKeptWithinTheLimitsOfTheJoint) {
  FamilyScene scene(damiaoIn(GetParam()));
  scene.forget();
  for (const double direction : {1.0, -1.0}) {
    if (scene.kind() == ControlKind::position) {
      const std::string refusal = scene.setpoint("joint", 2.6 * direction);
      scene.run(4s);
      EXPECT_NEAR(scene.position("joint"), refusal.empty() ? 2.0 * direction : 1.1, 1e-3)
          << refusal;
      continue;
    }
    const double value = scene.kind() == ControlKind::velocity ? 1.5 : 0.3;
    const Time end = scene.now() + 5s;
    while (scene.now() < end) {
      (void)scene.setpoint("joint", direction * value);
      scene.run(20ms);
    }
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-2) << scene.told();
    EXPECT_GT(direction * scene.position("joint"), 1.8) << "it went that far";
    if (!scene.truth("joint").power_stage_on) scene.mustSucceed(ProcedureKind::enable);
  }
  const bool torque = scene.kind() == ControlKind::torque;
  EXPECT_LT(scene.seen("joint").highest, 2.0 + (torque ? 0.15 : 0.01)) << scene.told();
  EXPECT_GT(scene.seen("joint").lowest, -2.0 - (torque ? 0.15 : 0.01)) << scene.told();
}

INSTANTIATE_TEST_SUITE_P(All, DamiaoPosition, testing::ValuesIn(damiaoModes()),
                         [](const auto& tested) { return std::string(tested.param); });

/// Milliseconds from when the motor is within `window` of its goal to bit 10; -1: never
int untilReached(Scene& scene, double goal, double window) {
  int waited = -1;
  for (int ms = 0; ms < 4000; ++ms) {
    scene.run(1ms);
    const bool near = std::abs(scene.position("joint") - goal) <= window;
    if (near && waited < 0) waited = 0;
    if (waited >= 0 && (scene.truth("joint").statusword & 0x0400) != 0) return waited;
    if (waited >= 0) ++waited;
  }
  return -1;
}

// 6067h in rad, 6068h in s.
TEST(DamiaoWindows, OfPositionSayWhenBit10Comes) {
  for (const auto& [window, time] : {std::pair(0.02, 0.1), std::pair(0.3, 0.4)}) {
    FamilyScene scene(
        damiaoIn("position_velocity",
                 ", write: [{object: position_window, value: " + std::to_string(window) +
                     "}, {object: position_window_time, value: " + std::to_string(time) + "}]"));
    EXPECT_NEAR(floatIn(scene, 0x6067), window, 1e-6);
    EXPECT_NEAR(floatIn(scene, 0x6068), time, 1e-6);
    ASSERT_EQ(scene.setpoint("joint", -0.5), "");
    const int waited = untilReached(scene, -0.5, window);
    EXPECT_NEAR(waited, 1000.0 * time, 12.0) << window;
  }
}

// 606Dh to 606Fh, where the firmware lets them be written.
TEST(DamiaoWindows, OfVelocitySayWhenBits10And12Come) {
  const std::string writable =
      "dictionary: [[0x606D, 0, velocity_window, uint32, rw, t, f0.5], "
      "[0x606E, 0, velocity_window_time, uint32, rw, t, f0.1], "
      "[0x606F, 0, velocity_threshold, uint32, rw, t, f0.01]]";
  FamilyScene scene(damiaoIn("profile_velocity",
                             ", write: [{object: velocity_window, value: 0.05}, {object: "
                             "velocity_window_time, value: 0.3}, {object: velocity_threshold, "
                             "value: 0.4}]",
                             writable));
  EXPECT_NEAR(floatIn(scene, 0x606D), 0.05, 1e-6);
  EXPECT_NEAR(floatIn(scene, 0x606E), 0.3, 1e-6);
  EXPECT_NEAR(floatIn(scene, 0x606F), 0.4, 1e-6);
  int fast = -1, reached = -1;
  for (int ms = 0; ms < 1000; ++ms) {
    if (ms % 20 == 0) (void)scene.setpoint("joint", 1.0);
    scene.run(1ms);
    const unsigned word = scene.truth("joint").statusword;
    const double speed = scene.velocity("joint");
    if (speed < 0.35) {
      EXPECT_NE(word & 0x1000, 0U) << ms;
    }
    if (speed > 0.45) {
      EXPECT_EQ(word & 0x1000, 0U) << ms;
    }
    if (fast < 0 && speed > 0.95) fast = ms;
    if (reached < 0 && fast >= 0 && (word & 0x0400) != 0) reached = ms;
  }
  ASSERT_GE(fast, 0);
  EXPECT_NEAR(reached - fast, 300, 12);
  // Read-only, as chapter 4.4 prints them: told, and the boot goes on.
  Scene other(loadText(damiaoIn(
      "profile_velocity", ", write: [{object: velocity_window, value: 0.05, optional: true}]")));
  EXPECT_TRUE(other.boot()) << other.told();
}

// A window of 1 rad lets bit 10 come far from the goal: the driver looks for itself.
TEST(DamiaoWindows, ThatAreTooWideDeceiveNobody) {
  FamilyScene scene(damiaoIn("position_velocity",
                             ", write: [{object: position_window, value: 1.0}, {object: "
                             "position_window_time, value: 0.0}]"));
  ASSERT_EQ(scene.setpoint("joint", 0.3), "");
  scene.run(150ms);
  EXPECT_NE(scene.truth("joint").statusword & 0x0400, 0U) << "so it says";
  ASSERT_GT(std::abs(scene.position("joint") - 0.3), 0.1);
  EXPECT_GT(std::abs(scene.state("joint").velocity), 0.2);
  const bus::Answer declared = declare(scene, "joint", 0.0);
  EXPECT_FALSE(declared.success) << "not while it moves: " << declared.message;
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 0.3, 1e-3);
}

const char* const kBlindDrive = "state_machine: {following_error_is_fault: false}";

// 6065h does nothing in this drive: the driver sees a motor that stands though it is sent on.
TEST(DamiaoFollowing, IsWatchedByTheDriverWhereTheDriveDoesNot) {
  FamilyScene scene(damiaoIn("cyclic_position", "", kBlindDrive));
  scene.inject("joint", "blocked_rotor");
  const double held = scene.position("joint");
  ASSERT_EQ(scene.setpoint("joint", -1.0), "");
  scene.run(2s);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("joint (node 4)"), HasSubstr("the motor stands")));
  scene.forget();
  scene.inject("joint", "clear");
  scene.run(1s);
  EXPECT_LT(std::abs(scene.position("joint") - held), 0.02) << scene.told();
  EXPECT_LT(scene.seen("joint").fastest, 0.3) << "no leap";
}

// A motor that follows, but too far behind, ends a trajectory by its path tolerance.
TEST(DamiaoFollowing, BeyondThePathToleranceEndsTheTrajectory) {
  const std::string group =
      "groups:\n  arm: {joints: [joint], constraints: {joint: {trajectory: 0.05, goal: 0.01}}}\n";
  Scene scene(loadText(
      damiaoIn("cyclic_position", ", write: [{object: max_motor_speed, value: 0.3}]", kBlindDrive) +
      group));
  ASSERT_TRUE(scene.boot()) << scene.told();
  enableJoint(scene);
  ASSERT_TRUE(scene.move({-0.9}, 2s).success);
  scene.run(1500ms);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("arm: "), HasSubstr("joint"), HasSubstr("tolerance")));
  scene.run(2s);
  EXPECT_GT(scene.position("joint"), 0.0) << "it did not go on";
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
}

}  // namespace
}  // namespace cia402
