// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/group.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using motion::TrajectoryErrorCode;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

/// The groups arm (shoulder, elbow) and head (elbow).
config::RobotConfig robotWith(bool stop_group_on_fault = true) {
  config::RobotConfig robot = test::testRobot();
  robot.groups[0].stop_group_on_fault = stop_group_on_fault;
  config::GroupConfig head;
  head.name = "head";
  head.joints = {"elbow"};
  robot.groups.push_back(head);
  return robot;
}

struct GroupTest : testing::Test {
  explicit GroupTest(const config::RobotConfig& config = robotWith()) : world(config) {
    world.enable();
  }
  /// Velocity limit 2 rad/s, acceleration limit 10 rad/s² in counts a cycle, rounded.
  void expectSmooth(std::size_t drive) const {
    const auto& targets = world.drives[drive].targets;
    for (std::size_t i = 2; i < targets.size(); ++i) {
      ASSERT_LE(std::abs(targets[i] - targets[i - 1]), 800 + 1) << "cycle " << i;
      ASSERT_LE(std::abs(targets[i] - 2 * targets[i - 1] + targets[i - 2]), 16 + 3)
          << "cycle " << i;
    }
  }
  RobotWorld world;
};

TEST_F(GroupTest, FollowsATrajectoryToItsGoal) {
  ASSERT_EQ(world.move({1.0, -0.5}, 1.0).message, "arm: trajectory accepted");
  EXPECT_TRUE(world.group().executing());
  world.run(500ms);
  EXPECT_NEAR(world.drives[0].radians(), 0.5, 0.02);  // half-way, by symmetry
  EXPECT_NEAR(world.drives[1].radians(), -0.25, 0.01);
  world.run(600ms);
  EXPECT_EQ(world.drives[0].position, 100000);
  EXPECT_EQ(world.drives[1].position, -50000);
  EXPECT_FALSE(world.group().executing());
  EXPECT_EQ(world.eventsWith("arm: goal reached"), 1u);
  expectSmooth(0);
}

TEST_F(GroupTest, TakesPointsInTheOrderOfTheirNames) {
  TrajectoryCommand command = world.trajectory("arm", {{{-0.5, 1.0}, 1.0}});
  command.joints = {"elbow", "shoulder"};
  ASSERT_TRUE(world.call(command).success);
  world.run(1100ms);
  EXPECT_EQ(world.drives[0].position, 100000);
  EXPECT_EQ(world.drives[1].position, -50000);
}

TEST_F(GroupTest, WaitsForAStartTimeInTheFuture) {
  TrajectoryCommand command = world.trajectory("arm", {{{1.0, 0.0}, 1.0}});
  command.start_time = world.now + 500ms;
  ASSERT_TRUE(world.call(command).success);
  world.run(490ms);
  EXPECT_EQ(world.drives[0].position, 0);
  world.run(1100ms);
  EXPECT_EQ(world.drives[0].position, 100000);
}

TEST_F(GroupTest, RefusesUnknownJointsAndGroupsAndImpossibleTrajectories) {
  TrajectoryCommand command = world.trajectory("arm", {{{1.0, 0.0}, 1.0}});
  command.joints = {"shoulder", "knee"};
  EXPECT_THAT(world.call(command).message, AllOf(HasSubstr("knee"), HasSubstr("elbow")));
  EXPECT_THAT(world.move({1.0, 0.0}, 0.1).message, HasSubstr("shoulder"));
  EXPECT_THAT(world.move({9.0, 0.0}, 10.0).message, HasSubstr("shoulder"));
  EXPECT_EQ(world.call(world.trajectory("leg", {{{}, 1.0}})).message, "there is no group \"leg\"");
  world.run(1s);
  EXPECT_EQ(world.drives[0].position, 0);
}

TEST_F(GroupTest, RefusesWhileAnAxisIsDisabled) {
  ASSERT_TRUE(world.call(ProcedureKind::disable, "elbow").success);
  const Answer answer = world.move({1.0, 0.0}, 1.0);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("arm: trajectory refused: elbow (node 2)"),
                                    HasSubstr("not enabled"), HasSubstr("call enable")));
}

TEST_F(GroupTest, RefusesWhileAnAxisIsInAModeThatFollowsNoTrajectory) {
  ASSERT_TRUE(world.call(ProcedureKind::set_mode, "elbow", "cyclic_velocity").success);
  EXPECT_EQ(world.move({1.0, 0.0}, 1.0).message,
            "arm: trajectory refused: elbow is in mode cyclic_velocity, which does not follow "
            "trajectories: ~elbow/set_mode cyclic_position first");
}

TEST_F(GroupTest, RefusesWhileAnotherGroupMovesAnAxis) {
  ASSERT_TRUE(world.move({1.0}, 1.0, "head").success);
  EXPECT_EQ(world.move({1.0, 0.0}, 1.0).message,
            "arm: trajectory refused: elbow follows a trajectory of group head");
  world.run(1100ms);
  EXPECT_TRUE(world.move({1.0, 0.0}, 1.0).success);
}

TEST_F(GroupTest, RefusesWhileStreamedSetPointsMoveAnAxis) {
  (void)world.begin(SetpointCommand{1, 1.0});
  world.run(200ms);
  EXPECT_THAT(world.move({1.0, 0.0}, 1.0).message,
              HasSubstr("elbow is still moved by streamed set-points"));
  world.run(2s);
  EXPECT_TRUE(world.move({1.0, 0.0}, 1.0).success);
}

TEST(Group, RefusesWhileAnAxisIsNotHomed) {
  config::RobotConfig config = test::testRobot();
  config.axes[1].homing = test::homingOfOrder(0);
  RobotWorld world(config);
  world.enable();
  EXPECT_THAT(world.move({1.0, 0.0}, 1.0).message,
              AllOf(HasSubstr("elbow (node 2)"), HasSubstr("not homed")));
  ASSERT_TRUE(world.call(ProcedureKind::home).success);
  const Answer answer = world.move({1.0, 0.0}, 1.0);
  EXPECT_TRUE(answer.success) << answer.message;
}

TEST_F(GroupTest, TakesOverANewTrajectoryWithoutAJump) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(501ms);  // between two cycles, at 1.5 rad/s
  ASSERT_TRUE(world.move({0.0, 0.5}, 2.0).success);
  world.run(2100ms);
  EXPECT_EQ(world.drives[0].position, 0);
  EXPECT_EQ(world.drives[1].position, 50000);
  expectSmooth(0);
  expectSmooth(1);
  EXPECT_EQ(world.eventsWith("goal reached"), 1u);
}

TEST_F(GroupTest, TakesOverAtAStartTimeInTheFutureWithoutAJump) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(200ms);
  TrajectoryCommand command = world.trajectory("arm", {{{0.0, 0.5}, 2.0}});
  command.start_time = world.now + 301ms;
  ASSERT_TRUE(world.call(command).success);
  world.run(2500ms);
  EXPECT_EQ(world.drives[0].position, 0);
  expectSmooth(0);
  expectSmooth(1);
}

// 3t² - 2t³: 1.125 rad/s and 3 rad/s² after a quarter of the time.
TEST_F(GroupTest, GoesOnFromStandstillWhereItWasAfterMissedCycles) {
  ASSERT_TRUE(world.move({1.0, 0.0}, 1.0).success);
  world.run(250ms);
  const double from = world.group().commanded()[0].position;
  const double before = world.group().commanded()[0].velocity;
  EXPECT_NEAR(before, 1.125, 0.02);
  world.now += 50ms;
  world.drives[0].targets.clear();
  ASSERT_TRUE(world.runUntil([&] { return !world.drives[0].targets.empty(); }, 10ms));
  const motion::MotionState first = world.group().commanded()[0];
  EXPECT_NEAR(first.position, from, 3e-4);
  // 10 rad/s² in a cycle of 4 ms are 0.04 rad/s, 1/28 of the speed planned.
  EXPECT_NEAR(first.velocity, 0.04, 0.001);
  EXPECT_NEAR(first.acceleration, 3.0 / (28.125 * 28.125), 1e-3);
  double last = first.velocity;
  for (int cycle = 0; cycle < 24; ++cycle) {
    world.run(test::kPeriod);
    const double velocity = world.group().commanded()[0].velocity;
    EXPECT_LE(velocity - last, 0.04 + 1e-3) << cycle;
    EXPECT_GE(velocity, last) << cycle;
    last = velocity;
  }
  EXPECT_GT(last, 0.8);
  world.run(1s);
  EXPECT_EQ(world.drives[0].position, 100000);
  EXPECT_EQ(world.eventsWith("arm: goal reached"), 1u);
  expectSmooth(0);
}

TEST_F(GroupTest, StopsByARampOnAnEmptyTrajectory) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  const std::int32_t from = world.drives[0].position;
  ASSERT_EQ(world.call(world.trajectory("arm", {})).message, "arm: stopping");
  EXPECT_TRUE(world.group().stopping());
  world.run(140ms);
  EXPECT_TRUE(world.group().stopping()) << "the ramp takes 150 ms";
  EXPECT_EQ(world.eventsWith("arm: stopped"), 0u);
  world.run(160ms);
  EXPECT_FALSE(world.group().stopping());
  // 1.5 rad/s at 10 rad/s² take 0.1125 rad
  EXPECT_NEAR(world.drives[0].position - from, 11250, 1500);
  expectSmooth(0);
  EXPECT_EQ(world.eventsWith("arm: stopped by an empty trajectory"), 1u);
}

TEST_F(GroupTest, TakesOverFromAStopRampNowAndLater) {
  for (Duration later : {Duration(0), Duration(50ms), Duration(500ms)}) {
    ASSERT_TRUE(world.move({0.0, 0.0}, 3.0).success);
    world.run(3100ms);
    ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
    world.run(500ms);
    ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
    world.run(40ms);
    TrajectoryCommand command = world.trajectory("arm", {{{0.2, 0.0}, 2.0}});
    if (later > 0ms) command.start_time = world.now + later;
    const Answer answer = world.call(command);
    ASSERT_TRUE(answer.success) << answer.message;
    EXPECT_TRUE(world.group().executing());
    world.run(2100ms + later);
    EXPECT_EQ(world.drives[0].position, 20000);
    expectSmooth(0);
    expectSmooth(1);
  }
}

TEST_F(GroupTest, DropsAWaitingTrajectoryWhenItIsStopped) {
  TrajectoryCommand command = world.trajectory("arm", {{{1.0, 0.0}, 1.0}});
  ASSERT_TRUE(world.move({0.5, 0.0}, 1.0).success);
  world.run(400ms);
  command.start_time = world.now + 1s;
  ASSERT_TRUE(world.call(command).success);
  ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
  world.run(3s);
  EXPECT_LT(world.drives[0].radians(), 0.5);
  EXPECT_FALSE(world.group().executing());
}

TEST_F(GroupTest, StopsTheOtherJointsByARampWhenOneFaults) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  world.drives[1].fault(0x8611);
  world.run(1s);
  EXPECT_GT(world.drives[0].radians(), 0.55);
  EXPECT_LT(world.drives[0].radians(), 0.70);
  EXPECT_TRUE(world.drives[0].enabled());
  expectSmooth(0);
  EXPECT_EQ(world.eventsWith("arm: trajectory stopped: elbow (node 2): fault 0x8611"), 1u)
      << world.allEvents();
  EXPECT_FALSE(world.group().executing() || world.group().stopping());
}

struct LooseGroupTest : GroupTest {
  LooseGroupTest() : GroupTest(robotWith(false)) {}
};

TEST_F(LooseGroupTest, LeavesTheOtherJointsGoingWhenOneFaults) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  world.drives[1].fault(0x8611);
  world.run(1s);
  EXPECT_EQ(world.drives[0].position, 100000);
  expectSmooth(0);
  EXPECT_EQ(world.eventsWith("arm: goal reached"), 0u);
  EXPECT_EQ(world.eventsWith("arm: goal missed: elbow (node 2)"), 1u) << world.allEvents();
}

TEST_F(LooseGroupTest, StopsWhenNoJointIsLeft) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  for (auto& drive : world.drives) drive.fault(0x8611);
  world.run(1s);
  EXPECT_EQ(world.eventsWith("arm: trajectory stopped: no joint is enabled any more"), 1u);
}

TEST_F(LooseGroupTest, DoesNotMoveAJointThatIsEnabledAgainUnderWay) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 4.0).success);
  world.run(1s);
  world.drives[1].fault(0x8611);
  world.run(100ms);
  ASSERT_TRUE(world.call(ProcedureKind::clear_faults, "elbow").success);
  ASSERT_TRUE(world.call(ProcedureKind::enable, "elbow").success);
  ASSERT_TRUE(world.group().executing());
  const std::int32_t position = world.drives[1].position;
  world.run(500ms);
  EXPECT_EQ(world.drives[1].position, position);
  world.drives[1].targets.clear();
  // A new trajectory takes it along again, from where it stands.
  ASSERT_TRUE(world.move({0.0, 0.0}, 4.0).success);
  world.run(4100ms);
  EXPECT_EQ(world.drives[0].position, 0);
  EXPECT_EQ(world.drives[1].position, 0);
  expectSmooth(0);
  expectSmooth(1);
}

// --- Tolerances: a group of its own on the robot's axes, to see the codes
// -------------------------

struct GroupToleranceTest : testing::Test {
  GroupToleranceTest() { world.enable(); }
  Group make(config::JointTolerance elbow) {
    config::GroupConfig config;
    config.name = "test";
    config.joints = {"shoulder", "elbow"};
    config.goal_time = 0.5;
    config.tolerances["elbow"] = elbow;
    for (const drive::Axis& axis : world.robot.axes()) {
      motions.emplace_back(axis.config(), test::kPeriod);
    }
    return Group(config, {0, 1}, world.robot.axes());
  }
  TrajectoryOutcome start(Group& group, double shoulder, double elbow) {
    const auto points = world.trajectory("arm", {{{shoulder, elbow}, 1.0}}).points;
    return group.start({"shoulder", "elbow"}, points, {}, world.robot.axes(), motions, world.now);
  }
  /// The outcome and, in `took`, after how long.
  TrajectoryOutcome follow(Group& group) {
    const Time begun = world.now;
    while (world.now < begun + 5s) {
      world.run(test::kPeriod);
      const auto outcome = group.step(world.robot.axes(), motions, world.now);
      took = world.now - begun;
      if (outcome) return *outcome;
    }
    return {TrajectoryErrorCode::successful, "never ended"};
  }
  RobotWorld world;
  std::vector<AxisMotion> motions;
  Duration took{};
};

TEST_F(GroupToleranceTest, EndsWithSuccessWithinTheTolerances) {
  Group group = make({0.05, 0.01});
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(outcome.code, TrajectoryErrorCode::successful);
  EXPECT_EQ(outcome.message, "test: goal reached");
  EXPECT_NEAR(toSeconds(took), 1.0, 0.02);
  EXPECT_EQ(motions[1].owner(), nullptr);
}

TEST_F(GroupToleranceTest, EndsWithMinus4OffThePathAndStopsByARamp) {
  Group group = make({0.05, 0.01});
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  world.run(test::kPeriod);
  world.drives[1].disturbance = 5100;  // 0.051 rad off
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(static_cast<int>(outcome.code), -4);
  EXPECT_THAT(outcome.message, AllOf(HasSubstr("test: trajectory stopped: elbow is 0.05"),
                                     HasSubstr("rad off its path, the tolerance is 0.05")));
  EXPECT_LT(took, 600ms);
  EXPECT_LT(world.drives[0].radians(), 0.3);
}

TEST_F(GroupToleranceTest, EndsWithMinus5WhenTheGoalIsMissedAfterTheGoalTime) {
  Group group = make({0.0, 0.01});
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  world.drives[1].disturbance = 2000;  // 0.02 rad off
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(static_cast<int>(outcome.code), -5);
  EXPECT_EQ(outcome.message,
            "test: goal missed: elbow is 0.02 rad away after 0.5 s, the tolerance is 0.01");
  EXPECT_NEAR(toSeconds(took), 1.5, 0.02);
}

TEST_F(GroupToleranceTest, CallsASetPointBackThatRunsAwayFromAMotorThatStands) {
  Group group = make({0.0, 0.01});
  world.drives[1].blocked = true;
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(static_cast<int>(outcome.code), -4);
  EXPECT_THAT(outcome.message, AllOf(HasSubstr("test: trajectory stopped: elbow (node 2)"),
                                     HasSubstr("the motor stands while its set-points run")));
  world.run(100ms);
  EXPECT_EQ(world.drives[1].targets.back(), 0);
  EXPECT_LT(world.drives[0].radians(), 0.1);
}

TEST_F(GroupToleranceTest, SucceedsWhenTheGoalIsReachedWithinTheGoalTime) {
  Group group = make({0.0, 0.01});
  world.drives[1].disturbance = 2000;  // 0.02 rad off
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  world.drives[1].blocked = false;
  const Time begun = world.now;
  std::optional<TrajectoryOutcome> outcome;
  while (!outcome && world.now < begun + 3s) {
    world.run(test::kPeriod);
    if (world.now > begun + 1200ms) world.drives[1].disturbance = 0;
    outcome = group.step(world.robot.axes(), motions, world.now);
  }
  ASSERT_TRUE(outcome.has_value());
  EXPECT_EQ(outcome->code, TrajectoryErrorCode::successful);
  EXPECT_NEAR(toSeconds(world.now - begun), 1.2, 0.03);
}

TEST_F(GroupToleranceTest, DoesNotJudgeTheFirstCycleByAnEarlierTrajectory) {
  Group group = make({0.05, 0.01});
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  ASSERT_EQ(follow(group).code, TrajectoryErrorCode::successful);
  world.run(2 * test::kPeriod);
  // Meanwhile the elbow moves on by other means.
  ASSERT_TRUE(world.move({0.5, 0.5}, 1.0).success);
  world.run(1100ms);
  world.run(1ms);  // so that feedback comes between the start and the first cycle
  ASSERT_EQ(start(group, 0.5, 0.0).code, TrajectoryErrorCode::successful);
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(outcome.code, TrajectoryErrorCode::successful) << outcome.message;
}

TEST_F(GroupToleranceTest, GivesTheCodesOfRefusals) {
  Group group = make({});
  EXPECT_EQ(group.start({"shoulder"}, {}, {}, world.robot.axes(), motions, world.now).code,
            TrajectoryErrorCode::successful);  // stop needs no joints
  const auto points = world.trajectory("arm", {{{0.5, 0.5}, 1.0}}).points;
  EXPECT_EQ(group.start({"shoulder"}, points, {}, world.robot.axes(), motions, world.now).code,
            TrajectoryErrorCode::invalid_joints);
  EXPECT_EQ(start(group, 99.0, 0.0).code, TrajectoryErrorCode::invalid_goal);
  EXPECT_EQ(group
                .start({"shoulder", "elbow"}, points, world.now - 2s, world.robot.axes(), motions,
                       world.now)
                .code,
            TrajectoryErrorCode::old_header_timestamp);
  EXPECT_FALSE(group.executing());
}

}  // namespace
}  // namespace cia402::bus
