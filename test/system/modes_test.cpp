// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every mode of both families on a whole robot: nothing jumps, and the drives do what was said.
#include "system/field_profile.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

constexpr double kNoJump = 2e-4;  // rad; 131072 counts * 100: 4e-7 rad a count

constexpr char kAllModes[] = ", modes: [pp, vl, pv, ip, csp, csv]";

class EnablingAt : public testing::TestWithParam<double> {};

TEST_P(EnablingAt, MovesNoGenericDriveInAnyMode) {
  for (const char* mode : {"pp", "vl", "pv", "ip", "csp", "csv"}) {
    Scene scene(loadText(
        genericPair(", mode: " + std::string(mode) +
                    ", simulation: {initial_position: " + std::to_string(GetParam()) + "}")));
    ASSERT_TRUE(scene.boot()) << scene.told();
    scene.forget();
    const auto enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
    EXPECT_TRUE(scene.truth("left").power_stage_on) << mode;
    scene.run(500ms);
    EXPECT_NEAR(scene.position("left"), GetParam(), kNoJump) << mode;
    EXPECT_LT(scene.seen("left").travel(), kNoJump) << mode;
    EXPECT_NEAR(scene.state("left").position, GetParam(), kNoJump) << mode;
  }
}

TEST_P(EnablingAt, MovesNoDamiaoInAnyMode) {
  for (const char* mode :
       {"profile_position", "position_velocity", "position_velocity_torque", "cyclic_position",
        "profile_velocity", "cyclic_velocity", "velocity_torque", "profile_torque"}) {
    LoadedRobot loaded = loadText(damiaoJoint());
    loaded.drives[0].mechanics[0].initial_position = GetParam() / 6.283185307179586;
    loaded.robot.axes[0].mode = mode;
    Scene scene(std::move(loaded));
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_EQ(scene.drive("joint").dictionary().find({0x607A, 0})->number, 0u);
    scene.forget();
    const auto enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << mode << ": " << enabled.message;
    scene.run(500ms);
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << mode;
    EXPECT_LT(scene.seen("joint").travel(), kNoJump) << mode;
    EXPECT_EQ(scene.badFloats(), 0u) << mode;
  }
}

INSTANTIATE_TEST_SUITE_P(StartPositions, EnablingAt, testing::Values(-2.3, 1.9, 0.0));

TEST(GenericModes, EachModeTakesItsSetPoints) {
  Scene scene(
      loadText(genericPair(kAllModes + std::string(", simulation: {initial_position: -1.7}"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);

  const auto position_mode = [&](const char* mode, double goal) {
    const auto switched = scene.procedure(ProcedureKind::set_mode, "left", mode);
    ASSERT_TRUE(switched.success) << switched.message;
    EXPECT_EQ(scene.setpoint("left", goal), "");
    scene.run(4s);
    EXPECT_NEAR(scene.position("left"), goal, 1e-3) << mode;
    EXPECT_NEAR(scene.state("left").position, goal, 1e-3) << mode;
    EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3) << mode;
  };
  const auto velocity_mode = [&](const char* mode, double speed) {
    const auto switched = scene.procedure(ProcedureKind::set_mode, "left", mode);
    ASSERT_TRUE(switched.success) << switched.message;
    scene.stream("left", speed, 1s);
    EXPECT_NEAR(scene.velocity("left"), speed, 0.02) << mode;
    EXPECT_NEAR(scene.state("left").velocity, speed, 0.02) << mode;
    scene.run(200ms + 300ms);  // the stream has dried up
    EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3) << mode;
  };
  position_mode("pp", -0.4);
  velocity_mode("pv", 0.5);
  position_mode("csp", 0.8);
  velocity_mode("csv", -0.7);
  position_mode("ip", 0.3);
  velocity_mode("vl", 0.6);
  position_mode("ip", -0.2);
  velocity_mode("vl", -0.6);
  position_mode("pp", 1.1);
  position_mode("csp", -0.9);
  EXPECT_LE(scene.seen("left").fastest, 1.5 * 1.1);
  EXPECT_LT(scene.seen("right").travel(), kNoJump) << "the other axis was never enabled";
}

class GenericTorqueMode : public testing::TestWithParam<const char*> {
 protected:
  /// The left axis is enabled in the mode.
  static void begin(Scene& scene) {
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", GetParam()).success);
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success) << scene.told();
  }
  /// 6077h of the left axis, in 1/1000 of its rated torque.
  static int torque(Scene& scene) {
    return static_cast<std::int16_t>(scene.drive("left").dictionary().find({0x6077, 0})->number);
  }
};

// 0.64 N m by a gear of 100 are 64 N m: 12 N m are 187.5 / 1000 of them, 120 N m, its limit, 1875.
TEST_P(GenericTorqueMode, PushesAsHardAsItIsToldBothWays) {
  Scene scene(loadText(genericPair(", modes: [csp, pt, csv, cst]")));
  ASSERT_NO_FATAL_FAILURE(begin(scene));
  scene.forget();
  scene.run(500ms);
  EXPECT_LT(scene.seen("left").travel(), kNoJump) << "enabled, and nothing more";
  EXPECT_EQ(torque(scene), 0);
  scene.inject("left", "blocked_rotor");
  for (const double effort : {12.0, -12.0}) {
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success) << scene.told();
    scene.stream("left", effort, 500ms);
    EXPECT_NEAR(torque(scene), effort / 64.0 * 1000.0, 1.0);
    EXPECT_NEAR(scene.state("left").effort, effort, 0.1);
    scene.run(1s);
    EXPECT_EQ(torque(scene), 0) << "without a stream there is none";
  }
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success) << scene.told();
  const Time end = scene.now() + 500ms;
  int hardest = 0;
  while (scene.now() < end) {
    (void)scene.setpoint("left", 200.0);
    scene.run(20ms);
    hardest = std::max(hardest, torque(scene));
  }
  EXPECT_EQ(hardest, 1875) << "200 N m are cut to the limit";
}

// 6 N m are 93.75 / 1000. At its rated torque the motor takes 300 turns/s^2 in the file of the
// simulated drive: 28.1 turns/s^2 are 1.77 rad/s^2 of the joint, less what friction takes.
TEST_P(GenericTorqueMode, TurnsTheJointAsItIsPushedAndEndsAtRest) {
  for (const double way : {1.0, -1.0}) {
    Scene scene(loadText(genericPair(", modes: [csp, pt, csv, cst]")));
    ASSERT_NO_FATAL_FAILURE(begin(scene));
    const Time begin = scene.now();
    ASSERT_TRUE(scene.runUntil(
        [&] {
          (void)scene.setpoint("left", 6.0 * way);
          return way * scene.velocity("left") > 0.5;
        },
        2s))
        << scene.told();
    EXPECT_GT(toSeconds(scene.now() - begin), 0.5 / 1.8);
    EXPECT_NEAR(scene.state("left").position, scene.position("left"), 0.02);
    EXPECT_NEAR(scene.state("left").velocity, scene.velocity("left"), 0.05);
    scene.run(2s);
    EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3);
    EXPECT_LT(scene.seen("right").travel(), kNoJump);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, GenericTorqueMode, testing::Values("profile_torque", "cyclic_torque"),
                         [](const auto& tested) { return std::string(tested.param); });

/// Brings the axis somewhere else in the mode it is in, and to rest.
void wander(Scene& scene, const std::string& axis, double goal) {
  const drive::ModeSpec* mode = scene.state(axis).mode;
  ASSERT_NE(mode, nullptr);
  if (mode->kind == drive::ControlKind::position) {
    ASSERT_EQ(scene.setpoint(axis, goal), "");
    scene.run(3s);
  } else if (mode->kind == drive::ControlKind::velocity) {
    scene.stream(axis, goal > scene.state(axis).position ? 0.3 : -0.3, 400ms);
    scene.run(1s);
  }
}

TEST(GenericModes, NoSwitchJumpsWhateverTargetsAreStale) {
  Scene scene(
      loadText(genericPair(kAllModes + std::string(", simulation: {initial_position: 2.0}"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  double goal = -0.8;
  for (const char* mode : {"pv", "csp", "pp", "csv", "csp", "pv", "pp", "csv", "pv", "csp", "pp",
                           "ip", "vl",  "ip", "csv", "ip",  "pp", "vl", "csp", "vl", "pv"}) {
    wander(scene, "left", goal);
    goal = -goal;
    scene.forget();
    const auto switched = scene.procedure(ProcedureKind::set_mode, "left", mode);
    ASSERT_TRUE(switched.success) << switched.message;
    scene.run(300ms);
    EXPECT_LT(scene.seen("left").travel(), kNoJump) << mode;
    EXPECT_EQ(scene.state("left").mode->name, drive::canonicalModeName(mode));
    ASSERT_TRUE(scene.truth("left").power_stage_on) << mode << "\n" << scene.told();
  }
}

TEST(DamiaoModes, NoSwitchJumpsThoughTheDriveMustBeDisabledForIt) {
  Scene scene(loadText(damiaoJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  double goal = -0.5;
  for (const char* mode :
       {"profile_velocity", "cyclic_position", "position_velocity", "velocity_torque",
        "profile_position", "cyclic_velocity", "position_velocity_torque", "profile_torque",
        "position_velocity", "cyclic_position"}) {
    wander(scene, "joint", goal);
    goal = -goal;
    scene.forget();
    const auto switched = scene.procedure(ProcedureKind::set_mode, "joint", mode);
    ASSERT_TRUE(switched.success) << switched.message;
    EXPECT_THAT(switched.message, HasSubstr("disabled meanwhile as the drive demands"));
    scene.run(300ms);
    EXPECT_LT(scene.seen("joint").travel(), 2e-3) << mode;
    EXPECT_EQ(scene.state("joint").mode->name, mode);
    EXPECT_TRUE(scene.state("joint").ready_for_motion) << mode;
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << mode;
  }
  EXPECT_EQ(scene.badFloats(), 0u);
}

TEST(DamiaoModes, EachModeTakesItsSetPoints) {
  Scene scene(loadText(damiaoJoint()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  double goal = 0.0;
  for (const char* mode :
       {"profile_position", "position_velocity", "position_velocity_torque", "cyclic_position"}) {
    const auto switched = scene.procedure(ProcedureKind::set_mode, "joint", mode);
    ASSERT_TRUE(switched.success) << switched.message;
    goal = goal > 0.0 ? -0.6 : 0.7;
    ASSERT_EQ(scene.setpoint("joint", goal), "");
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), goal, 5e-3) << mode;
    EXPECT_NEAR(scene.state("joint").position, goal, 5e-3) << mode;
  }
  double speed = 0.5;
  for (const char* mode : {"profile_velocity", "cyclic_velocity", "velocity_torque"}) {
    ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "joint", mode).success) << mode;
    scene.stream("joint", speed, 500ms);
    EXPECT_NEAR(scene.velocity("joint"), speed, 0.03) << mode;
    scene.run(500ms);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-2) << mode;
    speed = -speed;
  }
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "joint", "profile_torque").success);
  scene.stream("joint", 0.3, 400ms);  // the drive's torque slope is 1 N m/s
  EXPECT_GT(scene.velocity("joint"), 0.0);
  scene.run(1s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 2e-2) << "without set-points there is no torque";
  EXPECT_EQ(scene.badFloats(), 0u);
}

TEST(DamiaoModes, NegativeAndZeroSetPointsNeverBecomeMinusZero) {
  Scene scene(loadText(damiaoJoint(", direction: -1, homing: {offset: 0.0}")));
  ASSERT_TRUE(scene.boot());
  const auto homed = scene.procedure(ProcedureKind::home);
  ASSERT_TRUE(homed.success) << homed.message;
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  EXPECT_EQ(scene.setpoint("joint", -0.0), "");
  scene.run(100ms);
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "joint", "cyclic_velocity").success);
  scene.stream("joint", -0.0, 100ms);
  scene.stream("joint", 0.4, 300ms);
  scene.stream("joint", -0.0, 300ms);
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "joint", "profile_torque").success);
  scene.stream("joint", -0.0, 100ms);
  EXPECT_EQ(scene.badFloats(), 0u);
  EXPECT_NE(scene.state("joint").state, drive::State::fault);
}

TEST(Modes, SetPointsThatAreNoNumbersAreRefusedAndReachNobody) {
  Scene scene(loadFile("arm.yaml"));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::home).success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.forget();
  for (const char* axis : {"shoulder", "elbow", "wrist", "gripper"}) {
    EXPECT_THAT(scene.setpoint(axis, std::nan("")), HasSubstr("not a finite number"));
    EXPECT_THAT(scene.setpoint(axis, HUGE_VAL), HasSubstr("not a finite number"));
  }
  scene.run(200ms);
  for (const char* axis : {"shoulder", "elbow", "wrist", "gripper"}) {
    EXPECT_LT(scene.seen(axis).travel(), kNoJump) << axis;
  }
  EXPECT_EQ(scene.badFloats(), 0u);
}

class CutOffSwitch : public testing::TestWithParam<bool> {};

// Parameter: the drive takes no mode while halted.
TEST_P(CutOffSwitch, IsMadeGoodByEnable) {
  const std::string keys = GetParam() ? "mode_change: {while_halted: false}" : "";
  const std::string habit = GetParam() ? "quirks: {halt_blocks_mode: true}" : "";
  Scene scene(loadText(fieldPair(keys, habit, ", modes: [csp, pp]")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  scene.inject("left", "sdo_silent");
  const auto switched = scene.begin(ProcedureKind::set_mode, "left", "pp");
  scene.run(300ms);
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt, "left").success);
  ASSERT_TRUE(switched->has_value() && !(*switched)->success);
  scene.run(5s);  // what is asked in vain has ended
  scene.inject("left", "clear");
  scene.run(100ms);
  const std::string advice = scene.procedure(ProcedureKind::recover, "left").message;
  EXPECT_THAT(advice, HasSubstr("left is halted"));
  scene.forget();
  if (GetParam()) {
    EXPECT_THAT(advice, HasSubstr("disable, then enable"));
    EXPECT_FALSE(scene.procedure(ProcedureKind::enable, "left").success);
    ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "left").success);
  }
  const auto enabled = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_THAT(call(scene, bus::ReadObjectCommand{"left", "6061:00"}).message, HasSubstr(" 1"));
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(recovered.success) << recovered.message;
  scene.run(300ms);
  EXPECT_LT(scene.seen("left").travel(), kNoJump);
}

INSTANTIATE_TEST_SUITE_P(OfADriveThatWhileHaltedTakes, CutOffSwitch, testing::Bool(),
                         [](const auto& param) {
                           return std::string(param.param ? "NoMode" : "AMode");
                         });

TEST(Modes, ADriveThatTakesNoModeWhileHaltedIsNotBrakedWhenItChanges) {
  Scene scene(loadText(fieldPair("mode_change: {while_halted: false}",
                                 "quirks: {halt_blocks_mode: true}", ", modes: [csp, pt]")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "pt").success);
  scene.stream("left", 2.0, 200ms);
  scene.run(2s);  // the end of the stream braked it
  ASSERT_NEAR(scene.velocity("left"), 0.0, 1e-3);
  scene.forget();
  const auto switched = scene.procedure(ProcedureKind::set_mode, "left", "csp");
  EXPECT_TRUE(switched.success) << switched.message;
  scene.run(300ms);
  EXPECT_LT(scene.seen("left").travel(), kNoJump);
}

}  // namespace
}  // namespace cia402
