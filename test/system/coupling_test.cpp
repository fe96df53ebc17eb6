// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A differential: two motors, two joints. Judged by the motors.
#include <random>

#include "system/scene.h"

namespace cia402 {
namespace {

using drive::ProcedureKind;
using motion::TrajectoryErrorCode;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

constexpr double kDifferential[2][2] = {{0.5, 0.5}, {1.0, -1.0}};

std::string text(const double (&matrix)[2][2]) {
  const auto row = [&](int i) {
    return "[" + std::to_string(matrix[i][0]) + ", " + std::to_string(matrix[i][1]) + "]";
  };
  return "[" + row(0) + ", " + row(1) + "]";
}

/// Joints pitch and roll on the axes m5 and m6, which turn to different sides and have other gears.
/// @param acceleration limit of both axes
std::string wrist(const double (&matrix)[2][2] = kDifferential, const std::string& group = {},
                  const std::string& acceleration = "9") {
  const std::string limits = ", limits: {velocity: 8, acceleration: " + acceleration + "}";
  return "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "defaults: {drive: generic_cia402, counts_per_turn: 131072, rated_torque: 0.64,\n"
         "  mode: cyclic_position}\n"
         "axes:\n"
         "  base: {node_id: 7, gear_ratio: 100, limits: {velocity: 1, acceleration: 4}}\n"
         "  m5: {node_id: 1, gear_ratio: 50" +
         limits +
         "}\n"
         "  m6: {node_id: 2, gear_ratio: 80, direction: -1" +
         limits +
         "}\n"
         "couplings:\n"
         "  - joints: [pitch, roll]\n"
         "    axes: [m5, m6]\n"
         "    matrix: " +
         text(matrix) +
         "\n"
         "    pitch: {limits: {lower: -1.0, upper: 1.2, velocity: 1.0, acceleration: 4.0}}\n"
         "    roll: {limits: {lower: -2.0, upper: 2.0, velocity: 2.0, acceleration: 8.0}}\n"
         "groups:\n"
         "  wrist: {joints: [pitch, roll]" +
         group + "}\n";
}

struct Wrist : ReadyScene {
  explicit Wrist(const std::string& yaml = wrist(), const double (&m)[2][2] = kDifferential)
      : ReadyScene(yaml), matrix(m) {}
  /// Where the joints truly are, by the motors.
  double pitch() { return matrix[0][0] * position("m5") + matrix[0][1] * position("m6"); }
  double roll() { return matrix[1][0] * position("m5") + matrix[1][1] * position("m6"); }
  bus::JointState shown(const std::string& name) {
    bus::JointState state;
    robot().network().cycle().joints().find(name)->show(state);
    return state;
  }
  bool rests() { return std::abs(velocity("m5")) < 1e-3 && std::abs(velocity("m6")) < 1e-3; }

  const double (&matrix)[2][2];
};

TEST(Coupling, ATrajectoryOfTheJointsMovesTheMotorsByTheInverse) {
  Wrist scene;
  ASSERT_EQ(scene.move({0.5, -1.0}, 2s).message, "wrist: trajectory accepted");
  double off = 0.0;
  scene.watch([&] { off = std::max(off, std::abs(scene.roll() + 2.0 * scene.pitch())); });
  scene.run(1s);
  EXPECT_NEAR(scene.pitch(), 0.25, 0.02) << "half-way, by symmetry";
  EXPECT_NEAR(scene.shown("pitch").velocity, 0.375, 0.01);  // 1.5 * 0.5 / 2
  EXPECT_NEAR(scene.shown("roll").velocity, -0.75, 0.02);
  scene.run(1500ms);
  // m5 = pitch + roll / 2, m6 = pitch - roll / 2; 131072 * 50 counts a turn are 1e-6 rad
  EXPECT_NEAR(scene.position("m5"), 0.0, 2e-6);
  EXPECT_NEAR(scene.position("m6"), 1.0, 2e-6);
  EXPECT_NEAR(scene.shown("pitch").position, 0.5, 2e-6);
  EXPECT_NEAR(scene.shown("roll").position, -1.0, 4e-6);
  EXPECT_LT(off, 2e-3) << "a straight way";
  EXPECT_THAT(scene.told(), HasSubstr("wrist: goal reached"));
}

TEST(Coupling, JointsHaveTheEffortsThatTheAxesAddUpTo) {
  Wrist scene;
  ASSERT_TRUE(scene.move({0.5, -1.0}, 2s).success);
  scene.run(300ms);
  const double m5 = scene.state("m5").effort, m6 = scene.state("m6").effort;
  ASSERT_GT(std::abs(m6), 1e-3);
  // The power is the same: pitch * p' + roll * r' = m5 * a' + m6 * b' for all velocities.
  EXPECT_NEAR(scene.shown("pitch").effort, m5 + m6, 1e-9);
  EXPECT_NEAR(scene.shown("roll").effort, 0.5 * m5 - 0.5 * m6, 1e-9);
}

TEST(Coupling, RandomMatricesBringTheJointsToTheirGoals) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> random(-1.5, 1.5);
  int tried = 0;
  while (tried < 12) {
    double matrix[2][2];
    for (auto& row : matrix) {
      for (double& element : row) element = std::round(random(engine) * 1e3) / 1e3;
    }
    const double determinant = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
    if (std::abs(determinant) < 0.5) continue;
    ++tried;
    Wrist scene(wrist(matrix, "", "40"), matrix);
    const double pitch = 0.5 * random(engine), roll = random(engine);
    ASSERT_TRUE(scene.move({pitch, roll}, 2500ms).success) << text(matrix);
    scene.run(3s);
    EXPECT_NEAR(scene.position("m5"), (matrix[1][1] * pitch - matrix[0][1] * roll) / determinant,
                2e-6)
        << text(matrix);
    EXPECT_NEAR(scene.position("m6"), (matrix[0][0] * roll - matrix[1][0] * pitch) / determinant,
                2e-6)
        << text(matrix);
    EXPECT_NEAR(scene.shown("pitch").position, pitch, 1e-5);
    EXPECT_NEAR(scene.shown("roll").position, roll, 1e-5);
  }
}

TEST(Coupling, LimitsAreThoseOfTheJoints) {
  Wrist scene;
  EXPECT_THAT(scene.move({1.3, 0.0}, 5s).message, AllOf(HasSubstr("pitch"), HasSubstr("1.2")));
  EXPECT_THAT(scene.move({0.5, 0.0}, 300ms).message, HasSubstr("pitch"));
  scene.forget();
  scene.run(500ms);
  expectNothingMoved(scene, "m5");
  expectNothingMoved(scene, "m6");
}

TEST(Coupling, AStopKeepsToTheWayOfTheJoints) {
  Wrist scene;
  ASSERT_TRUE(scene.move({0.5, -1.0}, 2s).success);
  scene.run(900ms);
  double off = 0.0;
  scene.watch([&] { off = std::max(off, std::abs(scene.roll() + 2.0 * scene.pitch())); });
  EXPECT_TRUE(scene.stopGroup().success);
  const double at = scene.pitch(), speed = 0.375;
  scene.run(500ms);
  EXPECT_TRUE(scene.rests());
  EXPECT_NEAR(scene.pitch() - at, speed * speed / 8.0, 0.01);  // v² / 2a, and what the motors lag
  EXPECT_LT(off, 2e-3);
}

TEST(Coupling, AHaltOfOneAxisStopsTheOtherOnTheSameWay) {
  Wrist scene;
  ASSERT_TRUE(scene.move({0.5, 0.2}, 2s).success);
  scene.run(900ms);
  double off = 0.0;
  const double ratio = 0.2 / 0.5;
  scene.watch([&] { off = std::max(off, std::abs(scene.roll() - ratio * scene.pitch())); });
  EXPECT_TRUE(scene.procedure(ProcedureKind::halt, "m5").success);
  scene.run(300ms);
  EXPECT_TRUE(scene.rests());
  EXPECT_LT(scene.pitch(), 0.4);
  EXPECT_LT(off, 1.5e-3) << "with ramps of their own they would be 3.4e-3 off it";
  EXPECT_THAT(scene.told(), HasSubstr("wrist: stopped: pitch (axes m5, m6): halt was called"));
  EXPECT_THAT(scene.move({0.0, 0.0}, 2s).message,
              AllOf(HasSubstr("m5 (node 1): halted"), HasSubstr("enable")));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  EXPECT_TRUE(scene.move({0.0, 0.0}, 2s).success);
  scene.run(2500ms);
  EXPECT_NEAR(scene.pitch(), 0.0, 1e-5);
}

TEST(Coupling, AFaultOfOneAxisStopsTheOther) {
  Wrist scene(wrist(kDifferential, ", stop_group_on_fault: false"));
  ASSERT_TRUE(scene.move({0.8, 0.0}, 2s).success);
  scene.run(900ms);
  scene.inject("m5", "0x7305");
  scene.run(300ms);
  const double at = scene.position("m6");
  EXPECT_LT(at, 0.6);
  scene.run(1s);
  EXPECT_NEAR(scene.position("m6"), at, 1e-4) << "the trajectory went on to 0.8";
  EXPECT_THAT(scene.move({0.0, 0.0}, 2s).message, HasSubstr("m5 (node 1): fault"));
}

TEST(Coupling, AnAxisThatIsNotEnabledKeepsAllItsJointsFromMoving) {
  Wrist scene;
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "m6").success);
  const bus::Answer refused = scene.move({0.3, 0.0}, 2s);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("m6 (node 2): not enabled"), HasSubstr("enable"),
                                     Not(HasSubstr("m5 (node"))));
}

TEST(Coupling, JointsAreUnknownWhileOneOfTheirAxesIs) {
  Wrist scene;
  scene.inject("m6", "silent");
  ASSERT_TRUE(scene.runUntil([&] { return !scene.state("m6").feedback_valid; }, 2s));
  scene.run(10ms);
  EXPECT_TRUE(std::isnan(scene.shown("pitch").position));
  EXPECT_TRUE(std::isnan(scene.shown("roll").position));
  EXPECT_FALSE(scene.shown("pitch").known);
  EXPECT_TRUE(scene.shown("base").known);
}

TEST(Coupling, AnAxisTakesNoSetPointAlone) {
  Wrist scene;
  scene.forget();
  EXPECT_EQ(scene.setpoint("m5", 0.5),
            "m5: set-point refused: the axes m5, m6 move pitch, roll together, and the limits are "
            "those of the joints: send a trajectory to their group");
  scene.run(300ms);
  expectNothingMoved(scene, "m5");
  EXPECT_EQ(scene.setpoint("base", 0.1), "");
}

TEST(Coupling, ItsJointsTakeNoSetPointsOfTheirGroup) {
  Wrist scene;
  scene.forget();
  const auto refusal = scene.ask(bus::GroupSetpointsCommand{0, {0.3, 0.5}, {}});
  ASSERT_TRUE(refusal->has_value());
  EXPECT_EQ((*refusal)->message,
            "wrist: set-points refused, nothing moves for them: pitch (axes m5, m6): several axes "
            "move it, which takes trajectories alone; roll (axes m5, m6): several axes move it, "
            "which takes trajectories alone");
  scene.run(300ms);
  expectNothingMoved(scene, "m5");
  expectNothingMoved(scene, "m6");
}

TEST(Coupling, JointsOfOneCouplingAreNamedTogether) {
  Wrist scene(wrist(kDifferential, ", allow_partial_joints_goal: true"));
  bus::TrajectoryCommand command;
  command.group = "wrist";
  command.joints = {"roll"};
  command.points = {{{0.5}, {0.0}, {}, 1s}};
  const auto answer = scene.call(command);
  EXPECT_EQ(answer.code, TrajectoryErrorCode::invalid_joints);
  EXPECT_EQ(answer.message,
            "wrist: trajectory refused: roll (axes m5, m6) is named without pitch, which the same "
            "axes move: name both");
}

TEST(Coupling, ServicesOfAGroupAreForTheAxesOfItsJoints) {
  Wrist scene;
  bus::ProcedureCommand off;
  off.group = "wrist";
  off.request.kind = ProcedureKind::disable;
  EXPECT_THAT(scene.call(off).message, HasSubstr("disable done on 2 of 2 axes"));
  EXPECT_EQ(scene.state("base").state, drive::State::operation_enabled);
  EXPECT_NE(scene.state("m5").state, drive::State::operation_enabled);
  EXPECT_NE(scene.state("m6").state, drive::State::operation_enabled);
}

TEST(Coupling, ATrajectoryReplacesAnotherWithoutAJump) {
  Wrist scene;
  ASSERT_TRUE(scene.move({0.5, -1.0}, 2s).success);
  scene.run(800ms);
  double last = scene.axis("m6").target(), furthest = 0.0;
  scene.watch([&] {
    const double target = scene.axis("m6").target();
    furthest = std::max(furthest, std::abs(target - last));
    last = target;
  });
  ASSERT_TRUE(scene.move({-0.2, 0.4}, 3s).success);
  scene.run(3500ms);
  EXPECT_LT(furthest, 0.8 * 0.004) << "m6 is at 0.75 rad/s at most";
  EXPECT_NEAR(scene.pitch(), -0.2, 1e-5);
  EXPECT_NEAR(scene.roll(), 0.4, 1e-5);
}

TEST(Coupling, AGoalThatIsBeyondALimitByRoundingIsReached) {
  Wrist scene;
  ASSERT_TRUE(scene.move({1.2 + 1e-6, 0.0}, 3s).success);  // it may be by 1e-6 of the range
  scene.run(3500ms);
  EXPECT_FALSE(scene.robot().network().cycle().groups()[0].executing()) << scene.told();
  EXPECT_NEAR(scene.pitch(), 1.2, 1e-5);
  ASSERT_TRUE(scene.move({1.2 - 1e-3, 0.0}, 1s).success);
  scene.run(1500ms);
  EXPECT_FALSE(scene.robot().network().cycle().groups()[0].executing());
}

TEST(Coupling, AfterMissedCyclesTheJointsGoOnWhereTheyAre) {
  Wrist scene;
  ASSERT_TRUE(scene.move({0.5, -1.0}, 2s).success);
  scene.run(900ms);
  scene.robot().freeze(60ms);
  scene.run(4s);
  EXPECT_NEAR(scene.pitch(), 0.5, 1e-5) << scene.told();
  EXPECT_LT(scene.seen("m6").fastest, 0.9);
}

}  // namespace
}  // namespace cia402
